"""What the gripper holds is a rigid body: a long rod resists turning, and it weighs where its centre is."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.held_object import MAX_GRASP_DISTANCE
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.records import Shape
from tests.unit.motion.arm.test_torque_variation import swing, within

ARM = Arm.of_variant()
ROD = Shape("rod", "box", (0.6, 0.03, 0.02), (0.0, 0.0, 0.0), mass=2.0)
CORNERS = np.array(list(product((-0.5, 0.5), repeat=3))) * ROD.size
MESH = Shape(
    "rod", "mesh", (1.0,), (0.0, 0.0, 0.0), mass=2.0, vertices=tuple(map(tuple, np.add(CORNERS, (0.1, 0.0, 0.0))))
)
RNG = np.random.default_rng(5)
Q, V, A = (RNG.uniform(-1.0, 1.0, (30, 6)) * span for span in (2.5, 1.5, 8.0))


def grasp(rng: np.random.Generator) -> np.ndarray:
    """Return a pose to the tool from an object that the gripper holds as far off as it can."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(random_state=rng.integers(10**6)).as_matrix()
    away = rng.normal(size=3)
    pose[:3, 3] = MAX_GRASP_DISTANCE * away / np.linalg.norm(away)
    return pose


def by_points(pose: np.ndarray) -> np.ndarray:
    """Return the torques (n, 6) for eight point masses that have the moments of the rod, by Newton along the motion."""
    points, h = pose[:3, :3] @ (CORNERS / np.sqrt(3.0)).T + pose[:3, 3:], 1e-4

    def places(q: np.ndarray) -> np.ndarray:
        tool = tool_pose(q, ARM)
        return np.asarray(tool[:, :3, :3] @ points + tool[:, :3, 3:])

    before, now, after = (places(Q + t * V + t**2 / 2 * A) for t in (-h, 0.0, h))
    force = (before - 2.0 * now + after) / h**2 + np.array([0.0, 0.0, 9.81])[:, None]
    columns = [(places(Q + h * turn) - places(Q - h * turn)) / (2.0 * h) for turn in np.eye(6)]
    return np.array([2.0 / 8 * np.sum(column * force, axis=(1, 2)) for column in columns]).T


@pytest.mark.parametrize("shape", [ROD, MESH], ids=lambda shape: shape.kind)
def test_it_asks_of_the_motors_what_its_mass_asks_wherever_that_is(shape: Shape) -> None:
    pose = grasp(np.random.default_rng(2))
    seen = pose.copy()
    if shape is MESH:  # whose own frame lies beside its middle
        seen[:3, 3] -= pose[:3, :3] @ (0.1, 0.0, 0.0)
    held = Dynamics(ARM, shape, seen).torques(Q, V, A) - Dynamics(ARM).torques(Q, V, A)
    np.testing.assert_allclose(held, by_points(pose), atol=1e-4)
    assert np.abs(held - Dynamics(ARM, shape).torques(Q, V, A) + Dynamics(ARM).torques(Q, V, A)).max() > 2.0  # [N m]


def test_held_nobody_knows_how_no_grasp_asks_more_than_the_bounds() -> None:
    unknown, rng = Dynamics(ARM, ROD), np.random.default_rng(11)
    motions = [swing(rng) for _ in range(6)]
    bounds = [unknown.motion_bounds(m.states, m.turns(), m.period, 7) for m in motions]
    hardest, point = unknown.torque_bounds(Q, V, np.abs(A).max(axis=0)), 0.0
    ball = Dynamics(ARM, Shape("ball", "sphere", (0.01,), (0.0, 0.0, 0.0), mass=2.0), np.eye(4))
    for _ in range(10):
        held = Dynamics(ARM, ROD, grasp(rng))
        assert np.all(np.abs(held.torques(Q, V, A)) <= hardest)
        for motion, most in zip(motions, bounds, strict=True):
            asked = np.array([np.abs(held.torques(*within(motion, share))) for share in (0.0, 0.5)]).max(axis=0)
            assert np.all(asked <= np.repeat(most, 7, axis=0)[: len(motion)])
            alone = ball.motion_bounds(motion.states, motion.turns(), motion.period, 1)
            point = max(point, float((asked / alone).max()))
    assert point > 1.0  # so the bounds of a point would not do


def test_what_is_light_and_small_hardly_counts() -> None:
    block = Shape("block", "box", (0.04, 0.04, 0.04), (0.0, 0.0, 0.0))
    motion = swing(np.random.default_rng(3))
    unknown, known = (Dynamics(ARM, block, pose) for pose in (None, np.eye(4)))
    more, less = (d.motion_bounds(motion.states, motion.turns(), motion.period) for d in (unknown, known))
    assert np.max((more - less) / ARM.limits.torque) < 0.01


def test_a_known_grasp_is_within_the_bounds_of_an_unknown_one() -> None:
    heavy = replace(ROD, mass=4.0)
    known = Dynamics(ARM, heavy, np.eye(4)).torque_bounds(Q, V, np.abs(A).max(axis=0))
    assert np.all(known <= Dynamics(ARM, heavy).torque_bounds(Q, V, np.abs(A).max(axis=0)))
