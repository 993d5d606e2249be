"""The arm as a value, which is passed to everything that plans, simulates, executes or draws."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from teachpath.errors import UnusableSettings
from teachpath.motion.arm.limits import JointLimits
from teachpath.motion.arm.puma560 import DEFAULT_VARIANT, GRASP_DEPTH, TOOL_LENGTH, VARIANTS, Link
from teachpath.motion.settings import MotionSettings


@dataclass(frozen=True)
class Arm:
    """One arm with its gripper; equal arms compute equal motions, and a plan is of one arm and no other.

    Attributes:
        name: of the published variant.
        links: its six rows, from the base to the flange.
        tool_length: from the flange to the grasp point [m].
        grasp_depth: by which the fingers overlap an object that they hold [m] (see `collision.grasp`).
        tool_speed: that elbow, wrist and tool centre point keep [m/s] (see `tool_speed`); None: no limit.
    """

    name: str
    links: tuple[Link, ...]
    tool_length: float = TOOL_LENGTH
    grasp_depth: float = GRASP_DEPTH
    tool_speed: float | None = None

    @classmethod
    def of_settings(cls, settings: MotionSettings) -> Arm:
        """Return the arm that settings describe: a published variant with its gripper and the limit of its speed."""
        variant = cls.of_variant(settings.variant)
        return replace(variant, grasp_depth=settings.grasp_depth, tool_speed=settings.tool_speed)

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
