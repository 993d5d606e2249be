"""A displaced curve: exact ends, the bound, and the same curve without a displacement."""

from __future__ import annotations

import numpy as np
import pytest

from teachpath.learning.adaptation.displaced_curve import displaced
from teachpath.nurbs import Curve

U = np.linspace(0.0, 1.0, 100)
CURVE = Curve(
    3,
    np.array([0, 0, 0, 0, 0.3, 0.6, 1, 1, 1, 1.0]),
    np.array([[0.4, -0.3, 0.4], [0.4, -0.2, 0.7], [0.5, 0, 0.8], [0.6, 0.0, 0.7], [0.6, 0.2, 0.7], [0.4, 0.3, 0.4]]),
    np.array([1, 1, 2, 1, 0.5, 1]),
)


def test_no_displacement_gives_the_same_curve() -> None:
    same, missed = displaced(CURVE, U, np.zeros((100, 3)), 1e-3, 60)
    np.testing.assert_array_equal(same.control_points, CURVE.control_points)
    np.testing.assert_array_equal(same.knots, CURVE.knots)
    assert missed == 0


def test_a_shift_moves_every_control_point_alike() -> None:
    shift = np.array([0.1, -0.2, 0.05])
    moved, _ = displaced(CURVE, U, np.tile(shift, (100, 1)), 1e-3, 60)
    np.testing.assert_allclose(moved.control_points, CURVE.control_points + shift, atol=1e-9)


@pytest.mark.parametrize("bound", [5e-3, 1e-3, 2e-4])
def test_it_follows_within_the_bound_and_ends_exactly(bound: float) -> None:
    displacements = 0.1 * np.column_stack([np.sin(5 * U), np.cos(3 * U), U**2])
    moved, missed = displaced(CURVE, U, displacements, bound, 60)
    off = np.linalg.norm(moved(U) - CURVE(U) - displacements, axis=1)
    assert missed == pytest.approx(off.max())
    assert off.max() <= bound
    assert off[[0, -1]].max() < 1e-9


def test_it_swings_nowhere_between_the_points() -> None:
    u, fine = np.sqrt(U), np.linspace(0.0, 1.0, 2001)  # few of them near the start
    for seed in range(4):
        hand = np.random.default_rng(seed).normal(0, 0.004, (100, 3))  # no curve follows it closely
        rough = 0.1 * np.sin(3 * u)[:, None] * np.ones(3) + hand
        between = np.column_stack([np.interp(fine, u, axis) for axis in rough.T])
        moved, missed = displaced(CURVE, u, rough, 1e-4, 60)
        assert np.linalg.norm(moved(fine) - CURVE(fine) - between, axis=1).max() < 3 * missed


def test_it_stops_at_the_most_control_points_and_says_how_far_it_is() -> None:
    displacements = 0.1 * np.sin(60 * U)[:, None] * np.ones(3)
    moved, missed = displaced(CURVE, U, displacements, 1e-4, 12)
    assert len(moved.control_points) == 12
    assert missed > 1e-4
