"""Learned paths through the paper's scene, for the tests."""

from dataclasses import replace

import numpy as np

from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.nurbs import Curve
from teachpath.records import Fit, LearnedPath, Scene, Shape

NEAR_X, MIDDLE, FAR_X = 0.38, 0.58, 0.78
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


def wandering(seed: int, *, degree: int = 5) -> Curve:
    """A random smooth path over the table, from one side to the other."""
    rng = np.random.default_rng(seed)
    along = np.linspace(-0.3, 0.3, 9)
    middle = np.column_stack([np.full(9, 0.58), along, np.full(9, 0.68)])
    return clamped(middle + rng.normal(0.0, 0.03, (9, 3)), degree=degree)


def hooked() -> Curve:
    """The way through the middle, with a hook of few millimetres at its beginning as a trembling hand makes it."""
    points = way(MIDDLE, degree=5).curve.control_points
    hook = points[0] + 0.001 * np.array([[0, 0, 0], [-2, -2, 4], [4, 4, 2], [8, -6, 12]])
    curve = np.concatenate([hook, points[1:]])
    inner = np.concatenate([[0.0, 0.012, 0.03], np.linspace(0.06, 1.0, len(curve) - 7)])
    return Curve(5, np.r_[np.zeros(5), inner, np.ones(5)], curve, np.ones(len(curve)))


def gated(seed: int) -> tuple[Curve, Scene]:
    """A random way over the table through two gates, about as narrow as the gripper is; every third carries a block."""
    rng = np.random.default_rng(seed)
    curve = wandering(seed)
    posts = []
    for u in rng.uniform(0.15, 0.85, 2):
        angle, half = rng.uniform(0.0, np.pi), rng.uniform(0.045, 0.08)
        for side in (half, -half):
            x, y = curve(u)[:2] + side * np.array([np.cos(angle), np.sin(angle)])
            posts.append(Shape(f"post {len(posts)}", "cylinder", (0.01, 0.2), (float(x), float(y), 0.6)))
    scene = empty_scene()
    block = Shape("block", "box", (0.03, 0.05, 0.08), tuple(curve(0.0)))
    return curve, replace(
        scene, obstacles=(*scene.obstacles, *posts), carried=block if seed % 3 == 0 else scene.carried
    )
