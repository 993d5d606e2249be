"""Random paths in random scenes, and the setpoints of a plan."""

import numpy as np

from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.motion.execution.governor import Governor
from teachpath.motion.planning.certificate import plan_trajectory
from teachpath.nurbs import Curve
from teachpath.records import Plan, Scene, Shape

DT = 0.004  # s


def random_case(seed: int) -> tuple[Curve, Scene]:
    """Return a random curve over the table, degree 3 to 5, and a scene with a box, a cylinder and a sphere."""
    rng = np.random.default_rng(seed)
    count, degree = int(rng.integers(6, 12)), int(rng.integers(3, 6))
    ends = rng.uniform([0.35, -0.4, 0.6], [0.7, 0.4, 0.85], (2, 3))
    points = ends[0] + np.linspace(0, 1, count)[:, None] * (ends[1] - ends[0]) + rng.normal(0.0, 0.035, (count, 3))
    knots = np.r_[np.zeros(degree), np.linspace(0.0, 1.0, count - degree + 1), np.ones(degree)]
    x, y = rng.uniform(0.3, 0.8, 3), rng.uniform(-0.45, 0.45, 3)
    shapes = (
        Shape("box", "box", (0.08, 0.06, 0.12), (x[0], y[0], 0.56)),
        Shape("post", "cylinder", (0.03, 0.15), (x[1], y[1], 0.575)),
        Shape("ball", "sphere", (0.05,), (x[2], y[2], 0.55)),
    )
    scene = Scene("random", (*empty_scene().obstacles, *shapes))
    return Curve(degree, knots, points, rng.uniform(0.7, 1.4, count)), scene


def streamed(made: Plan) -> np.ndarray:
    """Return the setpoints (n, 6) that the executor streams at full speed, at rest before and behind."""
    governor = Governor(plan_trajectory(made), DT)
    sent = [governor.motion[0, :6].copy()] * 4
    while not governor.progress.finished:
        governor.step()
        sent.append(governor.motion[0, :6].copy())
    return np.array([*sent, *sent[-1:] * 4])
