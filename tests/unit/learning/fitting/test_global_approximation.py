"""Laws of the approximation by knot removal: near in both directions, exact ends, no knot too many."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.spatial import cKDTree

from teachpath.learning.fitting.global_approximation import approximate_from_polygon
from teachpath.learning.fitting.knot_removal import remove_knots
from teachpath.nurbs import Curve
from teachpath.records import Array
from tests.unit.learning import synthetic

FINE_PARAMETERS = np.linspace(0.0, 1.0, 40_001)


def zigzag(seed: int) -> Array:
    """Points of two demonstrations, sorted by distance to the start."""
    rng = np.random.default_rng(seed)
    shown = [synthetic.demonstration(rng, duration=rng.uniform(0.8, 2.0)) for _ in range(2)]
    start = np.mean([d.positions[0] for d in shown], axis=0)
    pooled = np.concatenate([d.positions for d in shown])
    return np.concatenate([start[None], pooled[np.argsort(np.linalg.norm(pooled - start, axis=1))]])


def corners(seed: int) -> Array:
    """A few points anywhere, some of them twice."""
    rng = np.random.default_rng(seed)
    return np.repeat(rng.normal(0.0, 0.2, (rng.integers(2, 12), 3)), 2, axis=0)[: -rng.integers(1, 3)]


def loop(seed: int) -> Array:
    return synthetic.loop(100, noise=0.002, seed=seed)


KINDS: list[Callable[[int], Array]] = [zigzag, corners, loop]


def away(curve: Curve, points: Array) -> float:
    """Largest distance of a place of the curve from the polygon of the points."""
    gaps = np.linspace(points[:-1], points[1:], 200, axis=1).reshape(-1, points.shape[1])
    return float(cKDTree(gaps).query(curve(FINE_PARAMETERS))[0].max())


@pytest.mark.parametrize("shape", KINDS)
@pytest.mark.parametrize("degree", [1, 2, 3, 5])
@pytest.mark.parametrize("seed", range(4))
def test_the_bound_holds_in_both_directions_and_the_ends_are_exact(
    shape: Callable[[int], Array], degree: int, seed: int
) -> None:
    points = shape(seed)
    gap = np.linalg.norm(np.diff(points, axis=0), axis=1).max()
    for bound in (0.1, 0.02, 0.004):
        curve = approximate_from_polygon(points, bound, degree=degree).curve
        assert cKDTree(curve(FINE_PARAMETERS)).query(points)[0].max() <= bound + 1e-4
        assert cKDTree(points).query(curve(FINE_PARAMETERS))[0].max() <= bound + gap / 2
        assert away(curve, points) <= bound + gap / 200
        np.testing.assert_allclose(curve(np.array([0.0, 1.0])), points[[0, -1]], rtol=0, atol=1e-12)


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
@pytest.mark.parametrize("shape", KINDS)
def test_without_a_bound_the_curve_is_the_polygon(shape: Callable[[int], Array], degree: int) -> None:
    points = shape(7)
    approximation = approximate_from_polygon(points, 0.0, degree=degree)
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    polygon = np.column_stack([np.interp(FINE_PARAMETERS * s[-1], s, axis) for axis in points.T])
    np.testing.assert_allclose(approximation.curve(FINE_PARAMETERS), polygon, rtol=0, atol=1e-11)


def test_points_on_a_line_need_no_knots() -> None:
    curve = approximate_from_polygon(np.linspace([0.0, 0.0, 0.0], [0.5, 0.2, 0.1], 100), 0.001, degree=3).curve
    assert len(curve.weights) == 4


@pytest.mark.parametrize("most", [4, 12, 60])
def test_the_bound_is_widened_until_the_control_points_suffice_and_is_kept_then(most: int) -> None:
    points = zigzag(3)
    found = approximate_from_polygon(points, 0.002, degree=3, most=most)
    assert len(found.curve.weights) <= most
    assert found.bound > 0.002
    assert cKDTree(found.curve(FINE_PARAMETERS)).query(points)[0].max() <= found.bound + 1e-4
    assert away(found.curve, points) <= found.bound + 1e-3


def test_a_rigid_motion_moves_the_curve_with_the_points() -> None:
    points = zigzag(5)
    rotation = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    here, there = (approximate_from_polygon(p, 0.03, degree=3).curve for p in (points, points @ rotation.T + 0.7))
    np.testing.assert_allclose(there.control_points, here.control_points @ rotation.T + 0.7, atol=1e-8)


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5])
def test_knots_go_while_the_curve_stays_within_the_room_that_its_errors_leave(degree: int) -> None:
    rng = np.random.default_rng(degree)
    for bound in (0.0, 0.3, 1.0, 3.0):
        interior = np.repeat(np.linspace(0.1, 0.9, 9), rng.integers(1, degree + 1, 9))
        knots = np.concatenate([np.zeros(degree + 1), interior, np.ones(degree + 1)])
        points = rng.normal(size=(len(knots) - degree - 1, 3))
        at = np.linspace(0.0, 1.0, 2001)
        errors = rng.uniform(0.0, 0.2, len(at)) if bound else np.zeros(len(at))
        fewer, control = remove_knots(degree, knots, points, at, errors, bound)
        moved = np.linalg.norm(BSpline(knots, points, degree)(at) - BSpline(fewer, control, degree)(at), axis=1)
        assert np.all(moved <= bound - errors + 1e-9)
        assert len(fewer) < len(knots) if bound > 1 else len(fewer) <= len(knots)


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_inserted_knots_are_found_and_removed(degree: int) -> None:
    """The curve is of fewer knots; inserting more, with the library, changes nothing."""
    rng = np.random.default_rng(degree)
    knots = np.concatenate([np.zeros(degree + 1), [0.3, 0.6], np.ones(degree + 1)])
    curve = BSpline(knots, rng.normal(size=(len(knots) - degree - 1, 3)), degree)
    more = curve.insert_knot(0.45).insert_knot(0.8)
    size = len(more.t) - degree - 1
    at = np.linspace(0.0, 1.0, 500)
    fewer, control = remove_knots(degree, more.t, more.c[:size], at, np.zeros(len(at)), 1e-9)
    np.testing.assert_array_equal(fewer, knots)
    np.testing.assert_allclose(control, curve.c, atol=1e-8)
