import numpy as np
import pytest

from teachpath.motion import paper_scene, plan
from teachpath.motion.puma560 import ACCELERATION, JERK, SPEED
from teachpath.motion.timing import JointPath, fastest_box, joint_move, rest_to_rest
from tests.unit.motion.ways import FAR, MIDDLE, NEAR, way


@pytest.mark.parametrize("x", [NEAR, MIDDLE, FAR])
def test_the_box_keeps_the_triangle_bound_between_its_samples_too(x: float) -> None:
    made = plan(way(x), paper_scene())
    path = JointPath(made.lengths, made.joints)
    box = fastest_box(path)
    first, second, third = (np.abs(path(np.linspace(0, path.end, 20011), k)) for k in (1, 2, 3))
    v, a, j = box.velocity, box.acceleration, box.jerk
    assert np.all(first * v <= SPEED)
    assert np.all(second * v**2 + first * a <= ACCELERATION)
    assert np.all(third * v**3 + 3 * second * v * a + first * j <= JERK)


def test_a_smaller_share_of_the_limits_takes_longer() -> None:
    path = joint_move(np.zeros(6), np.array([1.0, -0.4, 0.2, 0.0, 0.9, 2.0]))
    durations = [rest_to_rest(path.end, fastest_box(path, share=share)) for share in (0.2, 0.5, 1.0)]
    assert durations == sorted(durations, reverse=True)


def test_a_joint_move_is_a_straight_line_from_end_to_end() -> None:
    start, goal = np.zeros(6), np.array([1.0, -0.4, 0.2, 0.0, 0.9, 2.0])
    path = joint_move(start, goal)
    np.testing.assert_allclose(path(0.0), start)
    np.testing.assert_allclose(path(path.end), goal)
    np.testing.assert_allclose(path(path.end * 0.3), 0.3 * goal)
    assert not path(0.7, 2).any()
    assert not path(0.7, 3).any()


def test_derivatives_of_a_path_are_those_of_its_values() -> None:
    s = np.linspace(0, 2, 80)
    path = JointPath(s, np.sin(np.outer(s, np.arange(1, 7) / 3)))
    at, h = np.linspace(0.1, 1.9, 50), 1e-4
    for order in (0, 1, 2):
        numeric = (path(at + h, order) - path(at - h, order)) / (2 * h)
        np.testing.assert_allclose(path(at, order + 1), numeric, atol=1e-6)
