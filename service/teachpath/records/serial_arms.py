"""An arm that a user's model describes: a chain of links, each moved by a revolute joint, with the tool at its end."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Final

from teachpath.records.arrays import Pose, Vector
from teachpath.records.later_fields import LATER_FIELD
from teachpath.records.motion import Shape

NO_POSE: Final[Pose] = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))


class LimitSource(StrEnum):
    """Who says what a limit is."""

    MODEL = "model"
    OPERATOR = "operator"
    DEFAULT = "default"


@dataclass(frozen=True, slots=True)
class JointLimit:
    """A limit of a joint, and who says so.

    Attributes:
        value: in the unit of what it limits [rad, rad/s, rad/s^2, rad/s^3 or N m].
        source: who says so.
    """

    value: float
    source: LimitSource


@dataclass(frozen=True, slots=True)
class RevoluteJoint:
    """A joint that turns its link against the link before.

    Attributes:
        name: in the model.
        anchor: a point on the axis, in the frame of the joint's own link [m].
        axis: unit vector, in the same frame.
        lower: least angle [rad].
        upper: largest angle [rad].
        speed: [rad/s].
        acceleration: [rad/s^2].
        jerk: [rad/s^3].
        torque: of the motor, at the joint [N m].
        armature: inertia of the motor, at the joint [kg m^2].
        damping: viscous friction at the joint [N m s].
        friction: Coulomb friction at the joint [N m].
    """

    name: str
    anchor: Vector
    axis: Vector
    lower: JointLimit
    upper: JointLimit
    speed: JointLimit
    acceleration: JointLimit
    jerk: JointLimit
    torque: JointLimit
    armature: float = 0.0
    damping: float = 0.0
    friction: float = 0.0


@dataclass(frozen=True, slots=True)
class SerialLink:
    """A link, with all that is fixed to it.

    Attributes:
        name: in the model.
        pose: to the frame of the link before from that of this link, while the joint is at zero.
        joint: that moves the link.
        mass: [kg].
        center: of mass, in the link's frame [m].
        inertia: moments xx, yy, zz and products xy, xz, yz about the centre of mass, along the link's axes [kg m^2].
        solids: that may collide, in the link's frame.
    """

    name: str
    pose: Pose
    joint: RevoluteJoint
    mass: float
    center: Vector
    inertia: tuple[float, ...]
    solids: tuple[Shape, ...]


@dataclass(frozen=True)
class SerialArm:
    """An arm of six or seven revolute joints, as a user's model describes it.

    Attributes:
        name: under which it is kept.
        links: from the base to the tool.
        tool: its pose to the last link; z points out of the tool.
        base: pose of the model to the world.
        base_solids: that do not move, in the model's frame.
        payload_mass: of what the tool carries besides the scene's object [kg].
        payload_center: its centre of mass in the tool's frame [m].
        held: joints of the model that are no joints of the arm (such as fingers); they rest where the model has them.
        gripper_length: from where teachpath's own gripper sits to the tool, along the tool's z [m]; 0: there is none.
    """

    name: str
    links: tuple[SerialLink, ...]
    tool: Pose
    base: Pose
    base_solids: tuple[Shape, ...] = ()
    payload_mass: float = 0.0
    payload_center: Vector = (0.0, 0.0, 0.0)
    held: tuple[str, ...] = ()
    gripper_length: float = field(default=0.0, repr=False, metadata=LATER_FIELD)

    @property
    def hash(self) -> str:
        """SHA-256 (hex) over all but the name: arms with the same hash compute the same motions."""
        # Arms were kept before one could have a gripper: their hashes hold.
        gripper = f" gripper {self.gripper_length!r}" if self.gripper_length else ""
        return hashlib.sha256((repr(replace(self, name="")) + gripper).encode()).hexdigest()

    @property
    def joints(self) -> tuple[RevoluteJoint, ...]:
        """The joints, from the base to the tool."""
        return tuple(link.joint for link in self.links)


@dataclass(frozen=True)
class StoredArm:
    """One version of an arm as it is kept.

    Attributes:
        arm: itself.
        hash: of the arm, as `SerialArm.hash`.
        file: name of the model's file.
        version: of this name, from 1.
        created_ns: when it was kept [ns since the Unix epoch].
    """

    arm: SerialArm
    hash: str
    file: str
    version: int = 0
    created_ns: int = 0

    @property
    def summary(self) -> ArmSummary:
        """What a list says of it."""
        names = tuple(joint.name for joint in self.arm.joints)
        return ArmSummary(self.arm.name, self.version, self.hash, self.file, self.created_ns, names, self.arm.held)


@dataclass(frozen=True, slots=True)
class ArmSummary:
    """What a list says of an arm that is kept: its newest version, and its joints by name.

    Attributes:
        name: of the arm.
        version: its newest, from 1.
        hash: of the arm, as `SerialArm.hash`.
        file: name of the model's file.
        created_ns: when that version was kept [ns since the Unix epoch].
        joints: from the base to the tool.
        held: joints of the model that are no joints of the arm.
    """

    name: str
    version: int
    hash: str
    file: str
    created_ns: int
    joints: tuple[str, ...]
    held: tuple[str, ...]
