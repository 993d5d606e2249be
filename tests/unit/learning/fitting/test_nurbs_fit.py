"""Laws of the error-bounded fit, checked by distances measured independently."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.spatial import cKDTree

from teachpath.learning.fitting.nurbs_fit import approximate, distances_to_curve
from teachpath.learning.resampling import at_equal_arc_length
from teachpath.nurbs import Curve
from teachpath.records import Array
from tests.unit.learning import synthetic


def nearest(curve: Curve, point: Array) -> float:
    """Nearest distance by dense search and a minimiser, not by the code under test."""
    u = np.linspace(0.0, 1.0, 20_001)
    best = u[np.argmin(np.linalg.norm(curve(u) - point, axis=1))]
    found = minimize_scalar(
        lambda at: float(np.linalg.norm(curve(at) - point)),
        bounds=(max(best - 1e-4, 0.0), min(best + 1e-4, 1.0)),
        method="bounded",
        options={"xatol": 1e-12},
    )
    return float(found.fun)


@pytest.mark.parametrize("degree", [2, 3, 5])
@pytest.mark.parametrize("bound", [0.01, 0.004, 0.001])
def test_the_bound_holds_and_the_ends_are_exact(degree: int, bound: float) -> None:
    points = synthetic.loop(300)
    fit = approximate(points, bound, degree=degree, most=60)
    assert fit.largest <= bound
    assert max(nearest(fit.curve, point) for point in points[::10]) <= bound
    np.testing.assert_allclose(fit.curve(np.array([0.0, 1.0])), points[[0, -1]], atol=1e-12)


def test_knots_and_weights_are_legal_and_inner_knots_distinct() -> None:
    curve = approximate(synthetic.loop(300), 0.001, degree=3, most=60).curve
    inner = curve.knots[4:-4]
    assert len(inner) > 0
    assert np.all(np.diff(inner) > 0)
    assert inner.min() > 0
    assert inner.max() < 1
    np.testing.assert_array_equal(curve.weights, 1.0)


def test_a_tighter_bound_never_takes_fewer_control_points() -> None:
    points = synthetic.loop(400)
    counts = [len(approximate(points, bound, degree=3, most=100).curve.weights) for bound in (0.02, 0.005, 0.001)]
    assert counts == sorted(counts)


def test_no_knot_is_left_that_the_bound_does_not_need() -> None:
    points = np.linspace([0.0, 0.0, 0.0], [0.5, 0.2, 0.1], 100)
    assert len(approximate(points, 0.001, degree=3, most=60).curve.weights) == 4


def test_noisy_points_within_the_bound_do_not_multiply_control_points() -> None:
    assert len(approximate(synthetic.loop(300, noise=0.001), 0.005, degree=3, most=60).curve.weights) <= 13


def test_a_bound_below_the_noise_stops_at_the_most_control_points() -> None:
    fit = approximate(synthetic.loop(300, noise=0.003), 0.0005, degree=3, most=25)
    assert fit.largest > 0.0005
    assert len(fit.curve.weights) <= 25


@pytest.mark.parametrize("count", [2, 3, 4, 5, 7])
def test_few_points_lower_the_degree_instead_of_failing(count: int) -> None:
    points = synthetic.loop(count)
    fit = approximate(points, 1.0, degree=5, most=60)
    np.testing.assert_allclose(fit.curve(np.array([0.0, 1.0])), points[[0, -1]], atol=1e-12)


def test_repeated_points_are_passed_over() -> None:
    points = synthetic.loop(100)
    fit = approximate(np.repeat(points, 3, axis=0), 0.002, degree=3, most=60)
    assert fit.largest <= 0.002
    assert distances_to_curve(fit.curve, points).max() <= 0.002


def test_a_rigid_motion_moves_the_curve_with_the_points() -> None:
    points = synthetic.loop(200)
    rotation = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    here, there = (approximate(p, 0.003, degree=3, most=60).curve for p in (points, points @ rotation.T + 0.7))
    np.testing.assert_allclose(there.control_points, here.control_points @ rotation.T + 0.7, atol=1e-9)


def test_measured_distances_agree_with_a_minimiser() -> None:
    curve = approximate(synthetic.loop(200), 0.005, degree=5, most=60).curve
    points = np.random.default_rng(2).uniform(-0.1, 0.6, (25, 3))
    np.testing.assert_allclose(distances_to_curve(curve, points), [nearest(curve, p) for p in points], atol=1e-6)


@pytest.mark.parametrize("shape", [synthetic.loop, synthetic.curl, synthetic.retreat, synthetic.closed])
@pytest.mark.parametrize("degree", [2, 3, 5])
@pytest.mark.parametrize("count", [12, 40, 200])
def test_no_part_of_the_curve_swings_away_from_the_points(
    shape: Callable[[int], Array], degree: int, count: int
) -> None:
    points = shape(count)
    for bound in (0.01, 0.002, 0.0005):
        fit = approximate(points, bound, degree=degree, most=100)
        gap = np.linalg.norm(np.diff(points, axis=0), axis=1).max()
        away = cKDTree(points).query(fit.curve(np.linspace(0.0, 1.0, 5000)))[0]
        assert away.max() <= max(bound, fit.largest) + gap / 2


def anywhere(rng: np.random.Generator) -> Array:
    """A few points anywhere, one after another up to four times."""
    return np.repeat(rng.normal(0.0, 0.2, (rng.integers(2, 20), 3)), rng.integers(1, 5), axis=0)


def cornered(rng: np.random.Generator) -> Array:
    """Many points on straight lines that meet at sharp corners."""
    return at_equal_arc_length(rng.normal(0.0, 0.2, (rng.integers(2, 8), 3)), 200)


def tangled(rng: np.random.Generator) -> Array:
    """A smooth walk with loops."""
    return np.cumsum(np.cumsum(rng.normal(0.0, 2e-4, (150, 3)), axis=0), axis=0)


def uneven(rng: np.random.Generator) -> Array:
    """Points that are dense at the beginning and far from each other at the end."""
    t = np.sort(rng.uniform(0.0, 1.0, 60) ** 3)
    return np.column_stack([np.sin(6 * t), np.cos(5 * t), t]) / 5


@pytest.mark.parametrize("drawn", [anywhere, cornered, tangled, uneven])
@pytest.mark.parametrize("degree", [3, 5])
def test_no_part_of_a_curve_swings_away_from_any_points(
    drawn: Callable[[np.random.Generator], Array], degree: int
) -> None:
    for seed in range(25):
        points = drawn(np.random.default_rng(seed))
        for bound in (0.01, 0.002):
            fit = approximate(points, bound, degree=degree, most=60)
            gap = np.linalg.norm(np.diff(points, axis=0), axis=1).max()
            away = cKDTree(points).query(fit.curve(np.linspace(0.0, 1.0, 5000)))[0]
            assert away.max() <= max(bound, fit.largest) + gap / 2
            assert distances_to_curve(fit.curve, points).max() <= fit.largest + 1e-5  # a polyline stands for the curve
