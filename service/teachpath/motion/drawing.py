"""The arm's body from simple solids: the one list that is drawn, simulated and checked for collisions."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, pi, radians, sin, sqrt
from typing import Final

from teachpath.motion.puma560 import FINGER_TRAVEL

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

WHITE: Final = 0xE8E6E0
DARK: Final = 0x3A3F47
STEEL: Final = 0x9AA3AD
BLUE: Final = 0x2B5C8A

UPRIGHT: Final[Quaternion] = (1.0, 0.0, 0.0, 0.0)
Z_ALONG_Y: Final[Quaternion] = (cos(radians(45)), sin(radians(-45)), 0.0, 0.0)  # the solid's z along y of the link


@dataclass(frozen=True, slots=True)
class Part:
    """One solid, fixed to a link.

    Attributes:
        name: unique, e.g. "upper arm".
        link: 0 for the fixed base (frame `world`), i for the Denavit-Hartenberg frame behind joint i.
        kind: `box` (size = full edges x, y, z), `cylinder` (radius, height; axis along its z), `sphere` (radius) or
            `prism` (thickness along its z, convex `outline` in its xy plane, counter-clockwise).
        position: of the solid's centre in the link's frame [m].
        orientation: of the solid in the link's frame.
        opens: how far the part moves, in the link's frame, when the gripper opens [m].
    """

    name: str
    link: int
    kind: str
    size: tuple[float, ...]
    position: Vector
    orientation: Quaternion = UPRIGHT
    color: int = WHITE
    outline: tuple[tuple[float, float], ...] = ()
    opens: Vector = (0.0, 0.0, 0.0)


def drawing() -> tuple[Part, ...]:
    """Return every solid of the Puma 560 and its gripper; proportions are our own after photographs of the arm."""
    return _PARTS


def _tapered(x0: float, r0: float, x1: float, r1: float, corners: int = 12) -> tuple[tuple[float, float], ...]:
    """Outline around two circles on the x axis, x0 < x1, joined by their outer tangents."""
    lean = atan2(r0 - r1, sqrt((x1 - x0) ** 2 - (r0 - r1) ** 2))
    quarter = pi / 2 - lean
    right = [-quarter + 2 * quarter * k / (corners - 1) for k in range(corners)]
    left = [quarter + (2 * pi - 2 * quarter) * k / (corners - 1) for k in range(corners)]
    return tuple([(x1 + r1 * cos(t), r1 * sin(t)) for t in right] + [(x0 + r0 * cos(t), r0 * sin(t)) for t in left])


_PARTS: Final = (
    Part("foot", 0, "cylinder", (0.16, 0.03), (0.0, 0.0, 0.015), color=DARK),
    Part("pedestal", 0, "cylinder", (0.085, 0.47), (0.0, 0.0, 0.265), color=DARK),
    Part("trunk", 1, "cylinder", (0.09, 0.27), (0.0, -0.035, 0.0), Z_ALONG_Y),
    Part("shoulder", 1, "cylinder", (0.1, 0.285), (0.0, 0.0, 0.0425)),
    Part("shoulder cap", 1, "cylinder", (0.075, 0.03), (0.0, 0.0, -0.115), color=BLUE),
    Part("upper arm", 2, "prism", (0.085,), (0.0, 0.0, 0.2325), outline=_tapered(-0.4318, 0.125, 0.0, 0.075)),
    Part("shoulder cover", 2, "cylinder", (0.08, 0.02), (-0.4318, 0.0, 0.285), color=BLUE),
    Part("elbow cover", 2, "cylinder", (0.05, 0.02), (0.0, 0.0, 0.285), color=BLUE),
    # The prism's x runs along z of frame 3 (the forearm), its z along -y, its y along -x.
    Part("forearm", 3, "prism", (0.07,), (0.0, 0.0, 0.0), (0.5, 0.5, -0.5, 0.5),
         outline=_tapered(-0.02, 0.08, 0.31, 0.05)),
    Part("wrist roll", 4, "cylinder", (0.038, 0.075), (0.0, -0.075, 0.0), Z_ALONG_Y, STEEL),
    Part("wrist yoke", 4, "cylinder", (0.034, 0.09), (0.0, 0.0, 0.0), color=WHITE),
    Part("wrist", 5, "sphere", (0.037,), (0.0, 0.0, 0.0), color=STEEL),
    Part("flange", 6, "cylinder", (0.028, 0.025), (0.0, 0.0, -0.0125), color=DARK),
    Part("palm", 6, "box", (0.044, 0.11, 0.035), (0.0, 0.0, 0.0175), color=BLUE),
    Part("left finger", 6, "box", (0.022, 0.012, 0.1), (0.0, 0.026, 0.085), color=STEEL,
         opens=(0.0, FINGER_TRAVEL, 0.0)),
    Part("right finger", 6, "box", (0.022, 0.012, 0.1), (0.0, -0.026, 0.085), color=STEEL,
         opens=(0.0, -FINGER_TRAVEL, 0.0)),
)  # fmt: skip
