"""The arm's solids: one list for drawing, simulation and collision checking.

A Puma 560 has a slim column with a drum across its top, a long tapered upper arm at one end of the drum, beside the
column, a thinner forearm on the inner side of the elbow, and a slender wrist.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, pi, radians, sin, sqrt
from typing import Final

from teachpath.motion.arm.puma560 import FINGER_TRAVEL

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

SHELL_COLOR: Final = 0xF7F2E6  # the shell
JOINT_COLOR: Final = 0x2F343B  # joints, foot and gripper
STEEL_COLOR: Final = 0xA3ABB4
PLATE_COLOR: Final = 0x1F4E87

FINGER_END: Final = 0.135  # [m] from the flange
ROD_RADIUS: Final = 0.011  # [m]

IDENTITY_ROTATION: Final[Quaternion] = (1.0, 0.0, 0.0, 0.0)
Z_TO_Y_ROTATION: Final[Quaternion] = (
    cos(radians(45)),
    sin(radians(-45)),
    0.0,
    0.0,
)  # turns the solid's z to the link's y


@dataclass(frozen=True, slots=True)
class LinkSolid:
    """One solid, fixed to a link.

    Attributes:
        name: unique, e.g. "upper arm".
        link: 0 for the fixed base (frame `world`), i for the Denavit-Hartenberg frame behind joint i.
        kind: `box` (size = full edges x, y, z), `cylinder` (radius, height; axis along its z), `sphere` (radius) or
            `prism` (thickness along its z, convex `outline` in its xy plane, counter-clockwise).
        position: of the solid's centre in the link's frame [m].
        orientation: of the solid in the link's frame.
        opening_offset: displacement in the link's frame while the gripper is open [m].
        visual_only: whether it is only drawn. Such a solid stands out of another one of its link by a few millimetres,
            where nothing can touch it.
    """

    name: str
    link: int
    kind: str
    size: tuple[float, ...]
    position: Vector
    orientation: Quaternion = IDENTITY_ROTATION
    color: int = SHELL_COLOR
    outline: tuple[tuple[float, float], ...] = ()
    opening_offset: Vector = (0.0, 0.0, 0.0)
    visual_only: bool = False


def collision_solids(tool_length: float = 0.0) -> tuple[LinkSolid, ...]:
    """Return the solids that are simulated and checked for collisions.

    Args:
        tool_length: from the flange to the tool centre point [m].
    """
    return tuple(solid for solid in visual_solids(tool_length) if not solid.visual_only)


def visual_solids(tool_length: float = 0.0) -> tuple[LinkSolid, ...]:
    """Return all solids of the Puma 560 and its gripper; the proportions are our own, after photographs of the arm.

    Args:
        tool_length: from the flange to the tool centre point [m]. What holds one that lies beyond the fingers is taken
            as a rod as thick as a finger.
    """
    beyond = tool_length - FINGER_END
    if beyond <= 0.0:
        return _SOLIDS
    rod = LinkSolid("tool", 6, "cylinder", (ROD_RADIUS, beyond), (0.0, 0.0, FINGER_END + beyond / 2), color=STEEL_COLOR)
    return (*_SOLIDS, rod)


def _tapered(x0: float, r0: float, x1: float, r1: float, corners: int = 12) -> tuple[tuple[float, float], ...]:
    """Outline around two circles on the x axis, x0 < x1, joined by their outer tangents."""
    lean = atan2(r0 - r1, sqrt((x1 - x0) ** 2 - (r0 - r1) ** 2))
    quarter = pi / 2 - lean
    right = [-quarter + 2 * quarter * k / (corners - 1) for k in range(corners)]
    left = [quarter + (2 * pi - 2 * quarter) * k / (corners - 1) for k in range(corners)]
    return tuple([(x1 + r1 * cos(t), r1 * sin(t)) for t in right] + [(x0 + r0 * cos(t), r0 * sin(t)) for t in left])


_SOLIDS: Final = (
    LinkSolid("foot", 0, "cylinder", (0.16, 0.03), (0.0, 0.0, 0.015), color=JOINT_COLOR),
    LinkSolid("pedestal", 0, "cylinder", (0.085, 0.47), (0.0, 0.0, 0.265)),
    LinkSolid("collar", 0, "cylinder", (0.088, 0.016), (0.0, 0.0, 0.494), color=JOINT_COLOR, visual_only=True),
    LinkSolid("trunk", 1, "cylinder", (0.09, 0.27), (0.0, -0.035, 0.0), Z_TO_Y_ROTATION),
    LinkSolid("shoulder", 1, "cylinder", (0.1, 0.285), (0.0, 0.0, 0.0425)),
    LinkSolid("shoulder cap", 1, "cylinder", (0.075, 0.03), (0.0, 0.0, -0.115), color=JOINT_COLOR),
    LinkSolid("shoulder ring", 1, "cylinder", (0.1015, 0.014), (0.0, 0.0, 0.183), color=JOINT_COLOR, visual_only=True),
    LinkSolid("upper arm", 2, "prism", (0.085,), (0.0, 0.0, 0.2325), outline=_tapered(-0.4318, 0.125, 0.0, 0.075)),
    LinkSolid("shoulder cover", 2, "cylinder", (0.08, 0.02), (-0.4318, 0.0, 0.285), color=JOINT_COLOR),
    LinkSolid("elbow cover", 2, "cylinder", (0.05, 0.02), (0.0, 0.0, 0.285), color=JOINT_COLOR),
    LinkSolid("name plate", 2, "box", (0.16, 0.022, 0.004), (-0.2, 0.0, 0.275), color=PLATE_COLOR, visual_only=True),
    LinkSolid("elbow ring", 2, "cylinder", (0.06, 0.008), (0.0, 0.0, 0.1885), color=JOINT_COLOR, visual_only=True),
    # The prism's x runs along z of frame 3 (the forearm), its z along -y, its y along -x.
    LinkSolid("forearm", 3, "prism", (0.07,), (0.0, 0.0, 0.0), (0.5, 0.5, -0.5, 0.5),
         outline=_tapered(-0.02, 0.08, 0.31, 0.05)),
    LinkSolid("wrist roll", 4, "cylinder", (0.038, 0.075), (0.0, -0.075, 0.0), Z_TO_Y_ROTATION, JOINT_COLOR),
    LinkSolid("wrist yoke", 4, "cylinder", (0.034, 0.09), (0.0, 0.0, 0.0)),
    LinkSolid("wrist", 5, "sphere", (0.037,), (0.0, 0.0, 0.0), color=JOINT_COLOR),
    LinkSolid("flange", 6, "cylinder", (0.028, 0.025), (0.0, 0.0, -0.0125), color=STEEL_COLOR),
    LinkSolid("palm", 6, "box", (0.044, 0.11, 0.035), (0.0, 0.0, 0.0175), color=JOINT_COLOR),
    LinkSolid("left finger", 6, "box", (0.022, 0.012, 0.1), (0.0, 0.026, 0.085), color=STEEL_COLOR,
         opening_offset=(0.0, FINGER_TRAVEL, 0.0)),
    LinkSolid("right finger", 6, "box", (0.022, 0.012, 0.1), (0.0, -0.026, 0.085), color=STEEL_COLOR,
         opening_offset=(0.0, -FINGER_TRAVEL, 0.0)),
)  # fmt: skip
