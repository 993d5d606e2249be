"""Laws of the orientations along a path: signs do not matter, the bound is one of angles."""

from __future__ import annotations

import numpy as np
import pytest

from teachpath.errors import LearningFailed
from teachpath.learning.fitting.orientation_fit import fit_orientations, mean_orientations, rotation_angles
from teachpath.learning.settings import LearningSettings
from teachpath.nurbs import unit_quaternions
from teachpath.records import Array, Trajectory
from tests.unit.learning import synthetic


def about_z(angle: Array) -> Array:
    return np.column_stack([np.cos(angle / 2), 0 * angle, 0 * angle, np.sin(angle / 2)])


def line(orientations: Array) -> Trajectory:
    count = len(orientations)
    return Trajectory(np.arange(count) * 0.02, np.linspace([0.0, 0, 0], [0.5, 0, 0], count), orientations)


def evenly(trajectory: Trajectory, count: int) -> tuple[Array, Array]:
    mean = mean_orientations([trajectory], count)
    assert mean is not None
    return mean, np.linspace(0, 1, count)


def test_angles_are_those_of_rotations_whatever_the_signs() -> None:
    turns = np.linspace(0, np.pi, 20)
    np.testing.assert_allclose(rotation_angles(about_z(turns), -about_z(0 * turns)), turns, atol=1e-9)


def test_the_mean_of_two_turns_is_half_way_whatever_their_signs() -> None:
    share = np.linspace(0, 1, 150)
    one, other = line(about_z(1.0 * share)), line(-about_z(1.6 * share))
    mean = mean_orientations([one, other], 50)
    assert mean is not None
    np.testing.assert_allclose(rotation_angles(mean, about_z(1.3 * np.linspace(0, 1, 50))), 0.0, atol=1e-2)
    assert np.all((mean[1:] * mean[:-1]).sum(axis=1) > 0.9)


def test_a_whole_turn_is_kept_though_both_ends_are_the_same_rotation() -> None:
    turned = line(about_z(np.linspace(0, 2 * np.pi, 300)))
    curve, largest = fit_orientations(1, lambda count: evenly(turned, count), 3, LearningSettings())
    assert largest <= LearningSettings().turn_bound
    half = unit_quaternions(curve, 0.5)
    assert rotation_angles(half[None], about_z(np.array([np.pi])))[0] < 0.1
    assert unit_quaternions(curve, 0.0) @ unit_quaternions(curve, 1.0) == pytest.approx(-1.0, abs=1e-3)


@pytest.mark.parametrize("bound", [0.1, 0.02, 0.005])
def test_the_bound_holds_and_the_ends_are_exact(bound: float) -> None:
    (d,) = synthetic.turning({"a": synthetic.experiment_2(1)["1"]}, noise=0.0).values()
    mean, at = evenly(d, 200)
    curve, largest = fit_orientations(1, lambda count: evenly(d, count), 5, LearningSettings(turn_bound=bound))
    assert largest <= bound
    np.testing.assert_allclose(rotation_angles(unit_quaternions(curve, at), mean).max(), largest)
    np.testing.assert_allclose(unit_quaternions(curve, np.array([0.0, 1.0])), mean[[0, -1]], atol=1e-12)


def test_a_bound_that_cannot_be_kept_is_refused_in_degrees() -> None:
    rng = np.random.default_rng(1)
    wild = rng.normal(size=(3200, 4))
    wild /= np.linalg.norm(wild, axis=1, keepdims=True)
    with pytest.raises(LearningFailed, match=r"within 2\.01°: .*raise learning\.turn_bound"):
        fit_orientations(1, lambda count: (wild[:count], np.linspace(0, 1, count)), 3, LearningSettings())


def test_a_turn_at_rest_is_followed_within_the_bound() -> None:
    share = np.linspace(0, 1, 200)
    resting = Trajectory(
        np.arange(200) * 0.02,
        np.column_stack([0.5 * share**2.5, 0 * share, 0 * share]),  # slow at the grasp, where the hand turns by 20°
        about_z(np.radians(20) * np.clip(5 * share, 0, 1)),
    )
    largest = fit_orientations(1, lambda count: evenly(resting, count), 3, LearningSettings())[1]
    assert largest <= LearningSettings().turn_bound
    with pytest.raises(LearningFailed, match="turn the object while it moves"):
        fit_orientations(1, lambda count: evenly(resting, 50), 3, LearningSettings())
