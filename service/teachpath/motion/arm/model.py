"""The arm as a value, which is passed to everything that plans, simulates, executes or draws."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from teachpath.errors import UnusableSettings
from teachpath.motion.arm.limits import JointLimits
from teachpath.motion.arm.puma560 import DEFAULT_VARIANT, TOOL_LENGTH, VARIANTS, Link


@dataclass(frozen=True)
class Arm:
    """One arm with its gripper; equal arms compute equal motions, and a plan is of one arm and no other.

    Attributes:
        name: of the published variant.
        links: its six rows, from the base to the flange.
        tool_length: from the flange to the grasp point [m].
    """

    name: str
    links: tuple[Link, ...]
    tool_length: float = TOOL_LENGTH

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
        """What the joints may do."""
        return JointLimits.of_links(self.links)
