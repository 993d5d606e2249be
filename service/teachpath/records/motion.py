"""What is planned: scenes, plans and their certificates."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

from teachpath.errors import UnusableInput
from teachpath.records.arrays import Array, Matrix, Quaternion, Vector
from teachpath.records.calibrations import Calibration
from teachpath.records.later_fields import LATER_FIELD
from teachpath_proto.keys import is_name, name_refusal

MAX_OUTPUT_REST = 60.0  # [s]

ShapeKind = Literal["box", "cylinder", "sphere", "mesh"]


@dataclass(frozen=True, slots=True)
class Shape:
    """One body of a scene.

    Attributes:
        name: of the shape within its scene.
        kind: `box` (size: full edges x, y, z), `cylinder` (radius, height; axis along its z), `sphere` (radius) or
            `mesh` (factor from its units to metres).
        size: what its kind says [m].
        position: of its centre, of a mesh its origin [m, world].
        color: RGB in 24 bits, 0xRRGGBB.
        orientation: to world from shape, unit quaternion w, x, y, z.
        file: OBJ, STL, PLY or GLB file of a mesh, beside the settings.
        vertices: of the mesh's convex hull or pieces, which take its place: three a triangle, in the file's units.
        mass: of the carried object [kg]; None: that of its volume at 300 kg/m^3, as a light wooden block has. Obstacles
            and zones have none.
        max_pieces: most convex pieces that a mesh is cut into when its file is read; 1: its hull.
        pieces: number of triangles of each convex piece of a mesh, in the order of `vertices`; empty: it is one hull.
    """

    name: str
    kind: ShapeKind
    size: tuple[float, ...]
    position: Vector
    color: int = 0x8090A0
    orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)
    file: str = ""
    vertices: tuple[Vector, ...] = ()
    # Not in the text by which arms are hashed: those that are kept hold, and an arm's links have masses of their own.
    mass: float | None = field(default=None, repr=False, metadata=LATER_FIELD)
    max_pieces: int = field(default=1, repr=False, metadata=LATER_FIELD)
    pieces: tuple[int, ...] = field(default=(), repr=False, metadata=LATER_FIELD)


@dataclass(frozen=True, slots=True)
class ObjectPose:
    """Where the object of a scene lies: its centre [m, world], and its orientation w, x, y, z.

    Attributes:
        position: of its centre [m, world].
        orientation: to world from object, unit quaternion w, x, y, z.
    """

    position: Vector
    orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Scene:
    """What stands around the arm. Obstacles include the table; `carried` is the object at its start, or None.

    Arm, gripper and carried object stay above the floor, inside every box of `keep_in` and out of every shape of
    `keep_out`; nothing stands in these zones, they are rules.

    Attributes:
        name: of the scene.
        obstacles: what stands there, the table among it.
        carried: the object where it lies; None: the scene has none.
        floor: height of the floor [m, world]; the arm's foot stands at 0.
        keep_in: boxes that arm, gripper and carried object stay inside.
        keep_out: shapes of any kind that they stay out of.
        display_name: what people call it; empty: its name. Plans hold whatever it is called, and have it empty.
    """

    name: str
    obstacles: tuple[Shape, ...] = ()
    carried: Shape | None = None
    floor: float = 0.0
    keep_in: tuple[Shape, ...] = ()
    keep_out: tuple[Shape, ...] = ()
    display_name: str = field(default="", compare=False, metadata=LATER_FIELD)

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
    """A largest or least value on a path and where it occurs.

    Attributes:
        value: in the unit of what it is the extreme of.
        place: in words, e.g. joint 3 at s = 0.412 m.
        s: arc length from the start of the path [m].
    """

    value: float
    place: str
    s: float


@dataclass(frozen=True, slots=True)
class ToolPose:
    """Pose of the tool to the flange: its centre point [m] and orientation; z points out of the gripper.

    Attributes:
        position: of the tool centre point [m, flange].
        orientation: to flange from tool, unit quaternion w, x, y, z; z points out of the gripper.
    """

    position: Vector
    orientation: Quaternion


@dataclass(frozen=True, slots=True)
class Signature:
    """What a station says with its key of a plan: that it made the plan, and what the certificate holds for.

    Attributes:
        arm: name of the published variant; of an arm that was added, its name and the begin of its hash.
        tool_length: from where the gripper sits to the tool centre point [m].
        settings: `motion` settings with which the plan was made.
        calibrations: of the demonstrations that the path was learned from.
        present_calibrations: the newest versions of these when the plan was made.
        issued_ns: when the plan was made [ns since the Unix epoch].
        expires_ns: when the certificate holds no longer [ns since the Unix epoch].
        mac: HMAC-SHA256 (hex) over the whole plan and the arm, by the station's signing key.
        tool: its pose to the flange; None: it lies on the axis of joint 6, `tool_length` ahead of the flange.
    """

    arm: str
    tool_length: float
    settings: dict[str, Any]
    calibrations: tuple[Calibration, ...]
    present_calibrations: tuple[Calibration, ...]
    issued_ns: int
    expires_ns: int
    mac: str
    tool: ToolPose | None = field(default=None, metadata=LATER_FIELD)


@dataclass(frozen=True, slots=True)
class CertificateQuery:
    """The executor's question whether the certificate of a stored plan holds: the plan's id and its signature."""

    plan: str
    mac: str


@dataclass(frozen=True, slots=True)
class SceneQuery:
    """The executor's question what stands around the arm in a scene now: the scene's name."""

    name: str


@dataclass(frozen=True, eq=False)
class Certificate:
    """The proof that the arm can follow a plan; uses are shares of the limits, at most 1.

    Attributes:
        digest: SHA-256 over plan, certificate and arm, without the plan's id, author and signature (hex).
        branch: of the arm on the whole path, in words, e.g. righty, elbow up.
        position_use: largest share of the joints' range.
        velocity_use: largest share of the joints' speed limits.
        acceleration_use: largest share of the joints' acceleration limits.
        jerk_use: largest share of the joints' jerk limits.
        torque_use: largest share of the motors' torque that any sequence of commands can ask for on the path.
        least_singular: least singular value of the Jacobian.
        clearance: least distance of arm and carried object to scene and self [m].
        tool_speed: the most of elbow, wrist and tool centre point on the path [m/s]; None: it was made before that was
            measured.
        signature: None: it was made outside a station, or before stations signed.
    """

    digest: str
    branch: str
    position_use: Extreme
    velocity_use: Extreme
    acceleration_use: Extreme
    jerk_use: Extreme
    torque_use: Extreme
    least_singular: Extreme
    clearance: Extreme
    tool_speed: Extreme | None = None
    signature: Signature | None = None


@dataclass(frozen=True, eq=False)
class ShownPosture:
    """The joints that a demonstration by an arm showed.

    Attributes:
        demonstration: its id.
        joints: (k, joints) at even shares of the length of its way [rad].
    """

    demonstration: str
    joints: Matrix


@dataclass(frozen=True, slots=True)
class ToolOutput:
    """An output of the arm that is on while the tool follows the path, e.g. of a nozzle, a spray gun or a torch.

    Attributes:
        name: of the output, as the arm's driver knows it.
        start: for which the arm rests at the start of the path with it on [s].
        end: for which the arm rests at the end of the path with it on [s].

    Raises:
        UnusableInput: the name is none, or it would rest for longer than a minute.
    """

    name: str
    start: float = 0.0
    end: float = 0.0

    def __post_init__(self) -> None:
        if not is_name(self.name):
            raise UnusableInput(name_refusal("tool output", self.name))
        for what, seconds in (("start", self.start), ("end", self.end)):
            if not 0.0 <= seconds <= MAX_OUTPUT_REST:
                raise UnusableInput(f"output {self.name}: {what} of {seconds:g} s is outside 0 to {MAX_OUTPUT_REST:g}")


@dataclass(frozen=True, slots=True)
class Posture:
    """How near a plan keeps to the joints that a demonstration showed.

    Attributes:
        demonstration: its id.
        distance: of the joint that is farthest from what was shown, at the same share of the way's length [rad].
    """

    demonstration: str
    distance: Extreme


@dataclass(frozen=True, eq=False)
class Plan:
    """Path plus timing plus certificate: all that the executor needs.

    Attributes:
        id: of the plan.
        path: id of the learned path.
        path_version: number of the path's version.
        scene: that it was checked against.
        lengths: (n,) arc length of the nodes [m], from 0, strictly increasing.
        joints: (n, joints) configurations at the nodes [rad]; between them a quintic spline runs, on even parameters
            from 0 to 1.
        squared_rates: (m,) coefficients of the square of the parameter's rate at full speed, a quadratic spline on
            even intervals [1/s^2].
        limits: (3, joints) of the joints' speed [rad/s], acceleration [rad/s^2] and jerk [rad/s^3] while they follow
            the path, at any override.
        above_start: (joints,) configuration above the start, from where the object is grasped.
        above_goal: (joints,) configuration above the goal, to where the arm retreats.
        duration: of the path at full speed [s].
        certificate: the proof that the arm can follow it.
        tool_speed: limit of elbow, wrist and tool centre point [m/s], at any override; None: no limit.
        posture: how near it keeps to the joints that were shown; None: no arm showed it, or they were not to count.
        output: of the arm that is on while the tool follows the path; None: none is.
        author: who had it planned, where the station asks; empty: not said.
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
    posture: Posture | None = field(default=None, metadata=LATER_FIELD)
    output: ToolOutput | None = field(default=None, metadata=LATER_FIELD)
    author: str = field(default="", metadata=LATER_FIELD)
