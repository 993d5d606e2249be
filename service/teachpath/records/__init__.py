"""The nouns, frozen: what the rooms hand to one another.

Conventions (ARCHITECTURE.md): metres, radians, seconds inside; integer nanoseconds since the Unix epoch at the edges
(names end in `_ns`); quaternions w, x, y, z; frame `world` unless another is named.
"""

from teachpath.records.arrays import Array, Matrix, Pose, Quaternion, Vector
from teachpath.records.assessments import Assessment, Failure, Suggestion
from teachpath.records.calibrations import Calibration, MeasuredCalibration, TaughtPoint
from teachpath.records.control import Command, JournalEntry, Lease, LeaseRequest, TeleopRequest
from teachpath.records.demonstrations import (
    Clock,
    Demonstration,
    Phase,
    RecordingDigest,
    Sample,
    StreamStatistics,
    Task,
    Trajectory,
    Verdict,
)
from teachpath.records.learned import Cluster, Deviation, Fit, Learned, LearnedPath, RunSummary, Score
from teachpath.records.motion import (
    Certificate,
    CertificateQuery,
    ExecutorStatus,
    Extreme,
    JointState,
    ObjectPose,
    Plan,
    Scene,
    Setpoint,
    Shape,
    Signature,
)
from teachpath.records.previews import MotionPreview, SegmentInterval
from teachpath.records.recording import (
    Amendment,
    FistCommand,
    HandState,
    RecordingRequest,
    RecordingState,
    RecordingStatus,
    Routine,
    StopRequest,
    TaskReference,
)
from teachpath.records.versions import MAIN_BRANCH, ControlPointChange, Difference, Version
from teachpath.records.work import Job, JobState

__all__ = [
    "MAIN_BRANCH",
    "Amendment",
    "Array",
    "Assessment",
    "Calibration",
    "Certificate",
    "CertificateQuery",
    "Clock",
    "Cluster",
    "Command",
    "ControlPointChange",
    "Demonstration",
    "Deviation",
    "Difference",
    "ExecutorStatus",
    "Extreme",
    "Failure",
    "FistCommand",
    "Fit",
    "HandState",
    "Job",
    "JobState",
    "JointState",
    "JournalEntry",
    "Learned",
    "LearnedPath",
    "Lease",
    "LeaseRequest",
    "Matrix",
    "MeasuredCalibration",
    "MotionPreview",
    "ObjectPose",
    "Phase",
    "Plan",
    "Pose",
    "Quaternion",
    "RecordingDigest",
    "RecordingRequest",
    "RecordingState",
    "RecordingStatus",
    "Routine",
    "RunSummary",
    "Sample",
    "Scene",
    "Score",
    "SegmentInterval",
    "Setpoint",
    "Shape",
    "Signature",
    "StopRequest",
    "StreamStatistics",
    "Suggestion",
    "Task",
    "TaskReference",
    "TaughtPoint",
    "TeleopRequest",
    "Trajectory",
    "Vector",
    "Verdict",
    "Version",
]
