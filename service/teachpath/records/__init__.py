"""The nouns, frozen: what the rooms hand to one another.

Conventions (ARCHITECTURE.md): metres, radians, seconds inside; integer nanoseconds since the Unix epoch at the edges
(names end in `_ns`); quaternions w, x, y, z; frame `world` unless another is named.
"""

from teachpath.records.access import (
    ROLES,
    AccessToken,
    Capability,
    CodeGrant,
    Person,
    Session,
    Subject,
    capabilities_of,
)
from teachpath.records.arrays import Array, Matrix, Pose, Quaternion, Vector
from teachpath.records.assessments import Assessment, Failure, Suggestion
from teachpath.records.audit import AuditEntry
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
from teachpath.records.execution import ExecutorStatus, JointState, Setpoint
from teachpath.records.learned import (
    Cluster,
    Deviation,
    Fit,
    Learned,
    LearnedPath,
    PathSummary,
    PlanSummary,
    RunSummary,
    Score,
)
from teachpath.records.motion import (
    Certificate,
    CertificateQuery,
    Extreme,
    ObjectPose,
    Plan,
    Scene,
    SceneQuery,
    Shape,
    Signature,
    ToolPose,
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
from teachpath.records.sample_columns import SampleColumns
from teachpath.records.sampled_motion import SampledMotion
from teachpath.records.scene_versions import SavedScene, SceneVersion
from teachpath.records.serial_arms import (
    ArmSummary,
    JointLimit,
    LimitSource,
    RevoluteJoint,
    SerialArm,
    SerialLink,
    StoredArm,
)
from teachpath.records.versions import MAIN_BRANCH, ControlPointChange, Difference, Version
from teachpath.records.work import Job, JobState

__all__ = [
    "MAIN_BRANCH",
    "ROLES",
    "AccessToken",
    "Amendment",
    "ArmSummary",
    "Array",
    "Assessment",
    "AuditEntry",
    "Calibration",
    "Capability",
    "Certificate",
    "CertificateQuery",
    "Clock",
    "Cluster",
    "CodeGrant",
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
    "JointLimit",
    "JointState",
    "JournalEntry",
    "Learned",
    "LearnedPath",
    "Lease",
    "LeaseRequest",
    "LimitSource",
    "Matrix",
    "MeasuredCalibration",
    "MotionPreview",
    "ObjectPose",
    "PathSummary",
    "Person",
    "Phase",
    "Plan",
    "PlanSummary",
    "Pose",
    "Quaternion",
    "RecordingDigest",
    "RecordingRequest",
    "RecordingState",
    "RecordingStatus",
    "RevoluteJoint",
    "Routine",
    "RunSummary",
    "Sample",
    "SampleColumns",
    "SampledMotion",
    "SavedScene",
    "Scene",
    "SceneQuery",
    "SceneVersion",
    "Score",
    "SegmentInterval",
    "SerialArm",
    "SerialLink",
    "Session",
    "Setpoint",
    "Shape",
    "Signature",
    "StopRequest",
    "StoredArm",
    "StreamStatistics",
    "Subject",
    "Suggestion",
    "Task",
    "TaskReference",
    "TaughtPoint",
    "TeleopRequest",
    "ToolPose",
    "Trajectory",
    "Vector",
    "Verdict",
    "Version",
    "capabilities_of",
]
