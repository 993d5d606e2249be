"""Learned paths through the paper's scene, for the tests."""

import numpy as np

from teachpath.motion import paper_scene
from teachpath.nurbs import Curve
from teachpath.records import Fit, LearnedPath

NEAR, MIDDLE, FAR = 0.38, 0.58, 0.78
HEIGHT = 0.60


def clamped(points: np.ndarray, *, degree: int = 3) -> Curve:
    inner = np.linspace(0.0, 1.0, len(points) - degree + 1)
    return Curve(degree, np.r_[np.zeros(degree), inner, np.ones(degree)], points, np.ones(len(points)))


def learned(curve: Curve) -> LearnedPath:
    return LearnedPath("path-1", "run-1", 1, 1, curve, Fit(0.005, 0.004, 0.002, 0.01))


def way(x: float, *, height: float = HEIGHT, degree: int = 3) -> LearnedPath:
    """From the block's start over y = 0 at `x` to the other side."""
    carried = paper_scene().carried
    assert carried is not None
    x0, y0, z0 = carried.position
    there = np.array(
        [
            [x0, y0, z0],
            [x0 + 0.15 * (x - x0), y0 + 0.01, z0 + 0.03],
            [x0 + 0.6 * (x - x0), -0.18, height],
            [x, -0.10, height],
            [x, 0.0, height],
        ]
    )
    back = there[-2::-1] * [1.0, -1.0, 1.0]
    return learned(clamped(np.concatenate([there, back]), degree=degree))
