"""Laws of the curve; geomdl, written independently, is the oracle."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull, Delaunay

from teachpath.errors import UnusableInput
from teachpath.exchange import to_geomdl
from teachpath.nurbs import Curve

U = np.linspace(0.0, 1.0, 101)


def random_curve(seed: int, degree: int = 3, count: int = 9, *, rational: bool = True) -> Curve:
    rng = np.random.default_rng(seed)
    interior = np.sort(rng.uniform(0.05, 0.95, count - degree - 1))
    knots = np.concatenate([np.zeros(degree + 1), interior, np.ones(degree + 1)])
    weights = rng.uniform(0.3, 3.0, count) if rational else np.ones(count)
    return Curve(degree, knots, rng.normal(size=(count, 3)), weights)


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 7])
def test_basis_functions_sum_to_one(degree: int) -> None:
    curve = random_curve(degree, degree, 12)
    constant = Curve(degree, curve.knots, np.ones((12, 3)), curve.weights)
    np.testing.assert_allclose(constant(U), 1.0, atol=1e-14)


def test_the_curve_stays_in_the_convex_hull_of_its_control_points() -> None:
    curve = random_curve(1)
    hull = Delaunay(curve.control_points[ConvexHull(curve.control_points).vertices])
    assert np.all(hull.find_simplex(curve(np.linspace(0.001, 0.999, 200)), tol=1e-9) >= 0)


def test_an_affine_map_of_the_control_points_maps_the_curve() -> None:
    curve = random_curve(2)
    matrix, offset = np.random.default_rng(3).normal(size=(3, 3)), np.array([1.0, -2.0, 3.0])
    mapped = Curve(curve.degree, curve.knots, curve.control_points @ matrix.T + offset, curve.weights)
    np.testing.assert_allclose(mapped(U), curve(U) @ matrix.T + offset, atol=1e-12)


def test_the_curve_begins_and_ends_on_its_first_and_last_control_point() -> None:
    curve = random_curve(4)
    np.testing.assert_allclose(curve(np.array([0.0, 1.0])), curve.control_points[[0, -1]], atol=1e-14)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_derivatives_agree_with_finite_differences(order: int) -> None:
    curve = random_curve(5, degree=5, count=10)
    h = 1e-5
    inside = np.linspace(0.01, 0.99, 57)
    inside = inside[np.abs(inside[:, None] - curve.knots).min(axis=1) > 2 * h]
    differences = (curve(inside + h, order - 1) - curve(inside - h, order - 1)) / (2 * h)
    exact = curve(inside, order)
    np.testing.assert_allclose(differences, exact, atol=1e-5 * np.abs(exact).max())


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_points_and_derivatives_agree_with_geomdl(degree: int) -> None:
    curve = random_curve(6 + degree, degree, 10)
    oracle = to_geomdl(curve)
    for u in np.linspace(0.0, 0.99, 12):
        expected = np.array(oracle.derivatives(float(u), 2))
        for order, value in enumerate(curve.derivatives(float(u), 2)):
            np.testing.assert_allclose(value, expected[order], atol=1e-9 * max(1.0, np.abs(expected[order]).max()))


def test_the_length_of_a_rational_arc_is_that_of_the_circle() -> None:
    root = np.sqrt(0.5)
    quarter = Curve(2, np.array([0, 0, 0, 1, 1, 1]), np.array([[1, 0, 0], [1, 1, 0], [0, 1, 0]]), [1, root, 1])
    np.testing.assert_allclose(np.linalg.norm(quarter(U), axis=1), 1.0, atol=1e-14)
    assert quarter.length() == pytest.approx(np.pi / 2, rel=1e-12)


def test_the_arrays_of_a_curve_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        random_curve(7).control_points[0, 0] = 1.0


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"degree": 8}, "outside 1 to 7"),
        ({"knots": np.zeros(3)}, "need 13 knots"),
        ({"weights": np.zeros(9)}, "weights are positive"),
        ({"weights": np.ones(3)}, "need 9 weights"),
        ({"control_points": np.full((9, 3), np.nan)}, "not finite"),
        ({"knots": np.linspace(0, 1, 13)}, "begins with"),
    ],
)
def test_an_illegal_curve_is_refused_in_words(change: dict[str, object], sentence: str) -> None:
    legal = random_curve(8)
    parts = {"degree": 3, "knots": legal.knots, "control_points": legal.control_points, "weights": legal.weights}
    with pytest.raises(UnusableInput, match=sentence):
        Curve(**(parts | change))  # type: ignore[arg-type]
