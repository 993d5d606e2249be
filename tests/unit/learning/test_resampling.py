"""Resampling keeps ends, order and shape."""

from __future__ import annotations

import numpy as np
import pytest

from teachpath.learning.resampling import arc_lengths, at_equal_arc_length, at_equal_times, smoothed, undersampled
from teachpath.records import Trajectory
from tests.unit.learning import synthetic


def one(seed: int = 1, **options: float) -> Trajectory:
    return synthetic.demonstration(np.random.default_rng(seed), **options)


def test_smoothing_keeps_the_ends_and_takes_noise_out() -> None:
    rough, clean = one(2), one(2, noise=0.0, tremor=0.0)
    smooth = smoothed(rough)
    np.testing.assert_array_equal(smooth[[0, -1]], rough.positions[[0, -1]])
    assert arc_lengths(smooth)[-1] < arc_lengths(rough.positions)[-1]
    np.testing.assert_allclose(smoothed(clean), clean.positions, atol=0.004)


def test_smoothing_leaves_a_straight_steady_motion_alone() -> None:
    line = np.linspace([0.0, 0.0, 0.0], [1.0, 2.0, 3.0], 60)
    np.testing.assert_allclose(smoothed(Trajectory(np.arange(60) * 0.02, line)), line, atol=1e-12)


def test_the_steps_are_equal_at_equal_arc_length_however_uneven_the_speed() -> None:
    t = np.linspace(0.0, 1.0, 400) ** 3
    arc = np.column_stack([np.cos(t), np.sin(t), 0 * t])
    even = at_equal_arc_length(arc, 50)
    np.testing.assert_array_equal(even[[0, -1]], arc[[0, -1]])
    steps = np.linalg.norm(np.diff(even, axis=0), axis=1)
    np.testing.assert_allclose(steps, steps.mean(), rtol=1e-3)


def test_standing_still_does_not_shift_points_at_equal_arc_length() -> None:
    path = synthetic.loop(200)
    paused = np.concatenate([path[:80], np.repeat(path[80:81], 50, axis=0), path[80:]])
    np.testing.assert_allclose(at_equal_arc_length(paused, 70), at_equal_arc_length(path, 70), atol=1e-12)


def test_equal_times_interpolate_between_the_samples() -> None:
    trajectory = Trajectory(np.array([0.0, 1.0, 3.0]), np.array([[0.0, 0, 0], [1, 0, 0], [3, 0, 0]]))
    np.testing.assert_allclose(at_equal_times(trajectory, 7)[:, 0], np.linspace(0, 3, 7))


def test_undersampling_keeps_the_order_and_invents_nothing() -> None:
    positions = np.column_stack([np.arange(50.0)] * 3)
    fewer = undersampled(positions, 20, np.random.default_rng(1))
    assert len(fewer) == 20
    assert np.all(np.diff(fewer[:, 0]) > 0)
    assert set(fewer[:, 0]) <= set(positions[:, 0])


@pytest.mark.parametrize("count", [5, 6, 9])
def test_very_short_trajectories_are_smoothed_without_harm(count: int) -> None:
    path = synthetic.loop(count)
    smooth = smoothed(Trajectory(np.arange(count) * 0.02, path))
    assert smooth.shape == path.shape
    np.testing.assert_array_equal(smooth[[0, -1]], path[[0, -1]])
