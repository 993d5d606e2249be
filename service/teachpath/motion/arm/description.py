"""How the arm is built, as a document for pages and other programs."""

from __future__ import annotations

from dataclasses import dataclass

from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import FINGER_TRAVEL
from teachpath.records import Array


@dataclass(frozen=True, slots=True)
class LinkGeometry:
    """A link by its standard Denavit-Hartenberg parameters: a and d [m], alpha [rad]."""

    a: float
    d: float
    alpha: float


@dataclass(frozen=True, eq=False)
class Robot:
    """How the arm is built.

    Attributes:
        name: of the arm in its keys.
        variant: the published table that its lengths and masses come from.
        links: from the base to the wrist.
        lower: (6,) limits of the joints [rad].
        upper: (6,) likewise.
        speed: (6,) limits [rad/s].
        acceleration: (6,) limits [rad/s^2].
        jerk: (6,) limits [rad/s^3].
        torque: (6,) limits [N m].
        tool_length: from the flange to the tool centre point [m].
        tool_speed: limit of elbow, wrist and tool centre point [m/s]; None: no limit.
        payload_mass: of what the flange carries besides the gripper and the scene's object [kg].
        payload_center: its centre of mass in the flange's frame [m].
        finger_travel: of each finger [m].
        home: configuration in which the arm waits [rad].
    """

    name: str
    variant: str
    links: tuple[LinkGeometry, ...]
    lower: Array
    upper: Array
    speed: Array
    acceleration: Array
    jerk: Array
    torque: Array
    tool_length: float
    finger_travel: float
    home: tuple[float, ...]
    tool_speed: float | None
    payload_mass: float
    payload_center: tuple[float, ...]


def describe_arm(arm: Arm, *, name: str, home: tuple[float, ...]) -> Robot:
    """Describe an arm.

    Args:
        name: of the arm in its keys.
        home: configuration in which it waits [rad].
    """
    limits = arm.limits
    return Robot(
        name=name,
        variant=arm.name,
        links=tuple(LinkGeometry(link.a, link.d, link.alpha) for link in arm.links),
        lower=limits.lower,
        upper=limits.upper,
        speed=limits.speed,
        acceleration=limits.acceleration,
        jerk=limits.jerk,
        torque=limits.torque,
        tool_length=arm.tool_length,
        finger_travel=FINGER_TRAVEL,
        home=home,
        tool_speed=arm.tool_speed,
        payload_mass=arm.payload.mass,
        payload_center=arm.payload.center,
    )
