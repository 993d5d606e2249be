"""The nouns, frozen: what the rooms hand to one another.

Conventions (ARCHITECTURE.md): metres, radians, seconds inside; integer nanoseconds since the Unix epoch at the edges
(names end in `_ns`); quaternions w, x, y, z; frame `world` unless another is named.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from teachpath.nurbs import Curve

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class Phase(StrEnum):
    """What the hand is doing within a demonstration."""

    REACH = "reach"
    TRANSPORT = "transport"  # begins with the grasp, ends with the release
    RETURN = "return"


@dataclass(frozen=True, slots=True)
class Sample:
    """One reading of glove and tracker, checked.

    `position` [m] and `orientation` (None when not measured) are in the tracker frame; `flexions` run from 0 (open)
    to 1 (closed); `device_ns` is the device's clock, `receive_ns` ours.
    """

    tracker: str
    sequence: int
    device_ns: int
    receive_ns: int
    position: Vector
    orientation: Quaternion | None
    flexions: tuple[float, ...]
    tracked: bool
    buttons: int = 0


@dataclass(frozen=True, slots=True)
class Calibration:
    """A named mapping to `world` from `tracker`: p_world = scale * R p_tracker + offset."""

    name: str
    scale: float = 1.0
    rotation: Quaternion = (1.0, 0.0, 0.0, 0.0)
    offset: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Shape:
    """One body of a scene: a `box` (size = full edges x, y, z) or an upright `cylinder` (size = radius, height)."""

    name: str
    kind: str
    size: tuple[float, ...]
    position: Vector  # of its centre [m]
    color: int = 0x8090A0


@dataclass(frozen=True, slots=True)
class Scene:
    """What stands around the arm. Obstacles include the table; `carried` is the object at its start, or None."""

    name: str
    obstacles: tuple[Shape, ...] = ()
    carried: Shape | None = None


@dataclass(frozen=True, slots=True)
class Task:
    """What is demonstrated: its name, its scene and the calibration of its demonstrations."""

    name: str
    scene: str
    calibration: str
    created_ns: int


@dataclass(frozen=True, eq=False)
class Trajectory:
    """The object's motion in its transport phase, world frame.

    Attributes:
        times: (n,) [s], from 0, strictly increasing (device clock).
        positions: (n, 3) [m].
        orientations: (n, 4) unit quaternions, or None when not measured.
    """

    times: Array
    positions: Array
    orientations: Array | None = None

    def __len__(self) -> int:
        return len(self.times)


@dataclass(frozen=True, slots=True)
class Account:
    """What became of the samples of one recording or demonstration."""

    received: int = 0
    lost: int = 0
    duplicated: int = 0
    reordered: int = 0
    refused: int = 0
    untracked: int = 0
    longest_gap_ns: int = 0
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Demonstration:
    """One trial, as a row: the samples are in its recording file.

    The transport phase is samples[grasp:release] of the recording.
    """

    id: str
    task: str
    number: int  # 1, 2, ... within its task
    source: str  # tracker name or file name
    calibration: Calibration
    created_ns: int
    duration: float  # of the transport phase [s]
    samples: int
    grasp: int
    release: int
    verdict: str  # clean, repaired, reject
    account: Account
    recording: str  # place of the MCAP file within the recordings


@dataclass(frozen=True, slots=True)
class Score:
    """How one demonstration fares in the selection of its cluster."""

    demonstration: str
    log_likelihood: float
    rank: int  # 1 = most consistent
    selected: bool
    note: str = ""


@dataclass(frozen=True, eq=False)
class Cluster:
    """One way of doing the task.

    Attributes:
        members: ids, most consistent first.
        scores: same order as `members`.
        convergence: log-likelihood of the model after each training iteration (Fig. 4).
        note: why selection was skipped or is unreliable; empty when neither.
    """

    index: int
    members: tuple[str, ...]
    scores: tuple[Score, ...]
    convergence: tuple[float, ...] = ()
    note: str = ""


@dataclass(frozen=True, slots=True)
class Fit:
    """How closely a learned path follows what it was fitted to: distances [m]."""

    bound: float
    largest: float
    rms: float
    tube: float  # largest distance of a selected demonstration from the path


@dataclass(frozen=True, eq=False)
class LearnedPath:
    """The NURBS of one cluster: the way of the object's centre in the world."""

    id: str
    run: str
    cluster: int
    version: int
    curve: Curve
    fit: Fit
    note: str = ""


@dataclass(frozen=True, eq=False)
class Learned:
    """The result of one learning run over a task's demonstrations.

    Attributes:
        linkage: (m - 1, 4) merges as scipy writes them: left, right, height [m], size; leaves in the order of
            `demonstrations`.
        threshold: height of the cut [m].
        versions: library versions that made it.
    """

    mode: str
    demonstrations: tuple[str, ...]
    linkage: Array
    threshold: float
    clusters: tuple[Cluster, ...]
    paths: tuple[LearnedPath, ...]
    notes: tuple[str, ...] = ()
    settings: dict[str, object] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Extreme:
    """A largest or least value on a path and where it occurs."""

    value: float
    place: str  # in words: "joint 3 at s = 0.412 m"
    s: float  # arc length from the start of the path [m]


@dataclass(frozen=True, eq=False)
class Certificate:
    """The proof that the arm can follow a plan; uses are shares of the limits, at most 1."""

    digest: str  # SHA-256 over path, scene, limits and timing
    branch: str
    position_use: Extreme
    velocity_use: Extreme
    acceleration_use: Extreme
    jerk_use: Extreme
    least_singular: Extreme
    clearance: Extreme  # of arm and carried object to scene and self [m]


@dataclass(frozen=True, eq=False)
class Plan:
    """Path plus timing plus certificate: all that the executor needs.

    Attributes:
        lengths: (n,) arc length of the nodes [m], from 0, strictly increasing.
        joints: (n, 6) configurations at the nodes [rad]; between them a quintic spline runs.
        limits: velocity, acceleration, jerk of s along the path [m/s, m/s^2, m/s^3] at full speed.
        above_start: (6,) configuration above the start, from where the object is grasped.
        above_goal: (6,) configuration above the goal, to where the arm retreats.
        duration: of the path at full speed [s].
    """

    id: str
    path: str
    path_version: int
    scene: Scene
    lengths: Array
    joints: Array
    limits: tuple[float, float, float]
    above_start: Array
    above_goal: Array
    duration: float
    certificate: Certificate


@dataclass(frozen=True, eq=False)
class Setpoint:
    """What the arm should do in one control period; joint arrays are (6,) in rad, rad/s, rad/s^2."""

    cycle: int
    nominal_ns: int
    sent_ns: int
    position: Array
    velocity: Array
    acceleration: Array
    gripper_closed: bool
    execution: str


@dataclass(frozen=True, eq=False)
class JointState:
    """What the arm does; joint arrays are (6,), `tracking_error` is the largest over the joints [rad]."""

    stamp_ns: int
    cycle: int
    position: Array
    velocity: Array
    torque: Array
    tracking_error: float
    missed: int
    holding: bool
    gripper_closed: bool
    object_position: Vector
    object_orientation: Quaternion
    execution: str = ""


@dataclass(frozen=True, slots=True)
class ExecutorStatus:
    """Where an execution stands; see proto/teachpath_proto/motion.proto for the fields."""

    execution: str = ""
    state: str = "idle"
    reason: str = ""
    progress: float = 0.0
    override: float = 1.0
    cycles: int = 0
    late: int = 0
    missed: int = 0
    lateness_p50_us: float = 0.0
    lateness_p99_us: float = 0.0
    lateness_max_us: float = 0.0
    limit_use: float = 0.0
    tracking_error: float = 0.0
    limit_place: str = ""
    duration: float = 0.0


class JobState(StrEnum):
    """The life of a job."""

    QUEUED = "queued"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"


@dataclass(frozen=True, slots=True)
class Job:
    """Background work on a task: `learn` or `plan`. `outcome` is the id of the run or plan it made."""

    id: str
    task: str
    kind: str
    request: dict[str, object]
    state: JobState
    fraction: float
    message: str
    outcome: str
    attempt: int
    created_ns: int
    finished_ns: int
