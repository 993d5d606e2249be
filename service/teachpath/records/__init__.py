"""The nouns, frozen: what the rooms hand to one another.

Conventions (ARCHITECTURE.md): metres, radians, seconds inside; integer nanoseconds since the Unix epoch at the edges
(names end in `_ns`); quaternions w, x, y, z; frame `world` unless another is named.
"""

from teachpath.records.arrays import Array, Quaternion, Vector
from teachpath.records.assessments import Assessment, Failure, Remedy
from teachpath.records.calibrations import Calibration, MeasuredCalibration, TaughtPoint
from teachpath.records.control import Command, JournalEntry, Lease, LeaseRequest, Mirroring
from teachpath.records.demonstrations import Clock, Demonstration, Phase, Sample, StreamStatistics, Task, Trajectory
from teachpath.records.learned import Cluster, Departure, Fit, Learned, LearnedPath, Score
from teachpath.records.motion import (
    Certificate,
    ExecutorStatus,
    Extreme,
    JointState,
    Plan,
    Scene,
    Setpoint,
    Shape,
)
from teachpath.records.versions import MAIN, Difference, Moved, Version
from teachpath.records.work import Job, JobState

__all__ = [
    "MAIN",
    "Array",
    "Assessment",
    "Calibration",
    "Certificate",
    "Clock",
    "Cluster",
    "Command",
    "Demonstration",
    "Departure",
    "Difference",
    "ExecutorStatus",
    "Extreme",
    "Failure",
    "Fit",
    "Job",
    "JobState",
    "JointState",
    "JournalEntry",
    "Learned",
    "LearnedPath",
    "Lease",
    "LeaseRequest",
    "MeasuredCalibration",
    "Mirroring",
    "Moved",
    "Phase",
    "Plan",
    "Quaternion",
    "Remedy",
    "Sample",
    "Scene",
    "Score",
    "Setpoint",
    "Shape",
    "StreamStatistics",
    "Task",
    "TaughtPoint",
    "Trajectory",
    "Vector",
    "Version",
]
