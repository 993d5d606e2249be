"""What moves: scenes, plans with their certificates, setpoints, joint states."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from teachpath.records.arrays import Array, Matrix, Quaternion, Vector
from teachpath.records.calibrations import Calibration
from teachpath_proto.control import ExecutorState


@dataclass(frozen=True, slots=True)
class Shape:
    """One body of a scene.

    Attributes:
        kind: `box` (size: full edges x, y, z), `cylinder` (radius, height; axis along its z), `sphere` (radius) or
            `mesh` (factor from its units to metres).
        size: what its kind says [m].
        position: of its centre, of a mesh its origin [m].
        orientation: of the shape in the world.
        file: OBJ or STL file of a mesh, beside the settings.
        vertices: of the mesh's convex hull, which takes its place: three a triangle, in the file's units.
    """

    name: str
    kind: str
    size: tuple[float, ...]
    position: Vector
    color: int = 0x8090A0
    orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)
    file: str = ""
    vertices: tuple[Vector, ...] = ()


@dataclass(frozen=True, slots=True)
class ObjectPose:
    """Where the object of a scene lies: its centre [m, world], and its orientation w, x, y, z."""

    position: Vector
    orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Scene:
    """What stands around the arm. Obstacles include the table; `carried` is the object at its start, or None.

    Arm, gripper and carried object stay above the floor, inside every box of `keep_in` and out of every shape of
    `keep_out`; nothing stands in these zones, they are rules.

    Attributes:
        floor: height of the floor [m, world]; the arm's foot stands at 0.
        keep_in: boxes.
        keep_out: shapes of any kind.
    """

    name: str
    obstacles: tuple[Shape, ...] = ()
    carried: Shape | None = None
    floor: float = 0.0
    keep_in: tuple[Shape, ...] = ()
    keep_out: tuple[Shape, ...] = ()

    @property
    def bodies(self) -> tuple[Shape, ...]:
        """All that stands in the scene, and its zones."""
        return self.obstacles + ((self.carried,) if self.carried else ()) + self.keep_in + self.keep_out

    def with_object(self, pose: ObjectPose) -> Scene:
        """Return the scene with its object in another pose; the scene itself when it has none."""
        if self.carried is None:
            return self
        return replace(self, carried=replace(self.carried, position=pose.position, orientation=pose.orientation))


@dataclass(frozen=True, slots=True)
class Extreme:
    """A largest or least value on a path and where it occurs."""

    value: float
    place: str  # in words: "joint 3 at s = 0.412 m"
    s: float  # arc length from the start of the path [m]


@dataclass(frozen=True, slots=True)
class Signature:
    """What a station says with its key of a plan: that it made the plan, and what the certificate holds for.

    Attributes:
        arm: name of the published variant.
        tool_length: from the flange to the grasp point [m].
        settings: `motion` settings with which the plan was made.
        calibrations: of the demonstrations that the path was learned from.
        present_calibrations: the newest versions of these when the plan was made.
        issued_ns: when the plan was made.
        expires_ns: when the certificate holds no longer.
        mac: HMAC-SHA256 (hex) over the whole plan and the arm, by the station's signing key.
    """

    arm: str
    tool_length: float
    settings: dict[str, Any]
    calibrations: tuple[Calibration, ...]
    present_calibrations: tuple[Calibration, ...]
    issued_ns: int
    expires_ns: int
    mac: str


@dataclass(frozen=True, slots=True)
class CertificateQuery:
    """The executor's question whether the certificate of a stored plan holds: the plan's id and its signature."""

    plan: str
    mac: str


@dataclass(frozen=True, eq=False)
class Certificate:
    """The proof that the arm can follow a plan; uses are shares of the limits, at most 1."""

    digest: str  # SHA-256 over plan, certificate and arm, without the plan's id and the signature
    branch: str
    position_use: Extreme
    velocity_use: Extreme
    acceleration_use: Extreme
    jerk_use: Extreme
    torque_use: Extreme  # the most that any sequence of commands can ask for on the path
    least_singular: Extreme
    clearance: Extreme  # of arm and carried object to scene and self [m]
    # the most of elbow, wrist and tool centre point on the path [m/s]; None: it was made before that was measured
    tool_speed: Extreme | None = None
    signature: Signature | None = None  # None: it was made outside a station, or before stations signed


@dataclass(frozen=True, eq=False)
class Plan:
    """Path plus timing plus certificate: all that the executor needs.

    Attributes:
        lengths: (n,) arc length of the nodes [m], from 0, strictly increasing.
        joints: (n, 6) configurations at the nodes [rad]; between them a quintic spline runs, on even parameters from
            0 to 1.
        squared_rates: (m,) coefficients of the square of the parameter's rate at full speed, a quadratic spline on even
            intervals [1/s^2].
        limits: (3, 6) of the joints' speed [rad/s], acceleration [rad/s^2] and jerk [rad/s^3] while they follow the
            path, at any override.
        tool_speed: limit of elbow, wrist and tool centre point [m/s], at any override; None: no limit.
        above_start: (6,) configuration above the start, from where the object is grasped.
        above_goal: (6,) configuration above the goal, to where the arm retreats.
        duration: of the path at full speed [s].
    """

    id: str
    path: str
    path_version: int
    scene: Scene
    lengths: Array
    joints: Matrix
    squared_rates: Array
    limits: Matrix
    above_start: Array
    above_goal: Array
    duration: float
    certificate: Certificate
    tool_speed: float | None = None


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
    on_path: bool = False
    # (n, 6) [rad], one control period apart, the first one period behind this setpoint; checked against all limits
    way_to_rest: Array = field(default_factory=lambda: np.empty((0, 6)))


@dataclass(frozen=True, eq=False)
class JointState:
    """What the arm does; joint arrays are (6,), `tracking_error` is the largest over the joints [rad].

    An arm that is `holding` follows the way to rest of setpoint `cycle`; once it is `stopped`, it rests at its end.

    Attributes:
        enabled: whether the drives are on.
        protective_stop: whether the arm's own controller has stopped it.
        fault: what is wrong with the arm, in words; empty: nothing.
        gripper_opening: measured between the fingers [m]; None where the arm does not measure it.
    """

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
    late: int = 0
    stopped: bool = False
    enabled: bool = True
    protective_stop: bool = False
    fault: str = ""
    gripper_opening: float | None = None

    @property
    def inability(self) -> str:
        """Why the arm can follow no setpoint, and the way out, in words; empty when it can."""
        if self.fault:
            return f"the arm reports a fault: {self.fault}; clear it at the arm"
        if self.protective_stop:
            return "the arm's own controller has stopped it (protective stop): see why, and release it at the arm"
        return "" if self.enabled else "the arm's drives are off: switch them on at the arm"


@dataclass(frozen=True, slots=True)
class ExecutorStatus:
    """Where an execution stands; see proto/teachpath_proto/motion.proto for the fields."""

    execution: str = ""
    state: ExecutorState = ExecutorState.IDLE
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
    length: float = 0.0
    activity: str = ""
    operator: str = ""
    asking: str = ""
    scheduling: str = ""
    hand_latency_p50_us: float = 0.0
    hand_latency_p99_us: float = 0.0
    ending: bool = False
    unasked_motion: str = ""
