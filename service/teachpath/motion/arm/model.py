"""The arm as a value, which is passed to everything that plans, simulates, executes or draws."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from teachpath.errors import UnusableSettings
from teachpath.motion.arm.limits import JointLimits
from teachpath.motion.arm.puma560 import DEFAULT_VARIANT, GRASP_DEPTH, TOOL_LENGTH, VARIANTS, Link
from teachpath.motion.settings import MotionSettings


@dataclass(frozen=True)
class Payload:
    """What the flange carries besides the gripper and the scene's object.

    Attributes:
        mass: [kg].
        center: of mass in the flange's frame [m].
    """

    mass: float = 0.0
    center: tuple[float, ...] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Arm:
    """One arm with its gripper; equal arms compute equal motions, and a plan is of one arm and no other.

    Attributes:
        name: of the published variant.
        links: its six rows, from the base to the flange.
        tool_length: from the flange to the tool centre point, between the fingers, on the axis of joint 6 [m].
        grasp_depth: by which the fingers overlap an object that they hold [m] (see `collision.grasp`).
        payload: that the flange carries.
        tool_speed: that elbow, wrist and tool centre point keep [m/s] (see `tool_speed`); None: no limit.
    """

    name: str
    links: tuple[Link, ...]
    tool_length: float = TOOL_LENGTH
    grasp_depth: float = GRASP_DEPTH
    payload: Payload = Payload()
    tool_speed: float | None = None

    @classmethod
    def of_settings(cls, settings: MotionSettings) -> Arm:
        """Return the arm that settings describe: a published variant with its tool, payload and limit of speed."""
        mass = settings.payload_mass
        return replace(
            cls.of_variant(settings.variant),
            tool_length=settings.tool_length,
            grasp_depth=settings.grasp_depth,
            payload=Payload(mass, tuple(settings.payload_center)) if mass else Payload(),  # nothing is nowhere
            tool_speed=settings.tool_speed,
        )

    @classmethod
    def of_variant(cls, name: str = DEFAULT_VARIANT) -> Arm:
        """Return the arm of a published variant.

        Raises:
            UnusableSettings: there is no such variant.
        """
        if name not in VARIANTS:
            raise UnusableSettings(f"setting motion.variant is {name!r}; known: {', '.join(VARIANTS)}")
        return cls(name, VARIANTS[name].links)

    @cached_property
    def limits(self) -> JointLimits:
        """What the joints may do, and how fast the tool may be."""
        return JointLimits.of_links(self.links, self.tool_speed)
