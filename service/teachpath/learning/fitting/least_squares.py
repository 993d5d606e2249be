"""Least squares with given knots and fixed end points (The NURBS Book, section 9.4.1)."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from teachpath.records import Array


class LeastSquares:
    """The least-squares problem of one list of points, to be solved with different knots.

    Args:
        points: (m, d) [m].
        u: (m,) their parameters from 0 to 1, not decreasing.
        degree: of the curve.
        ends: (2, d) where the curve begins and ends; None = on the first and the last point.
    """

    def __init__(self, points: Array, u: Array, degree: int, ends: Array | None = None) -> None:
        self.points = points
        self.u = u
        self.degree = degree
        self._ends = points[[0, -1]] if ends is None else ends

    def solve(self, interior: Array, *, determined: bool = False) -> tuple[Array, Array]:
        """Return control points (n, d) and the distance of each point from the curve at its parameter (m,).

        Args:
            interior: knots between 0 and 1.
            determined: refuse knots for which the points do not determine every control point.

        Raises:
            LinAlgError: they do not, and it was asked for.
        """
        basis = BSpline.design_matrix(self.u, clamped(interior, self.degree), self.degree)
        count = basis.shape[1]
        # Sums over the few entries of each row: products of sparse matrices this small take ten times as long.
        values = basis.data.reshape(len(self.u), self.degree + 1)
        columns = basis.indices.reshape(values.shape).astype(np.intp)
        control = np.empty((count, self.points.shape[1]))
        control[0], control[-1] = self._ends
        if count > 2:
            pairs = (columns[:, :, None] * count + columns[:, None, :]).ravel()
            products = (values[:, :, None] * values[:, None, :]).ravel()
            gram = np.asarray(np.bincount(pairs, products, count * count), dtype=np.float64).reshape(count, count)
            sums = [np.bincount(columns.ravel(), (values * axis[:, None]).ravel(), count) for axis in self.points.T]
            right = np.column_stack(sums) - gram[:, [0, -1]] @ control[[0, -1]]
            control[1:-1] = _normal_equations(gram[1:-1, 1:-1], right[1:-1], determined)
        followed = (values[:, :, None] * control[columns]).sum(axis=1)
        return control, np.linalg.norm(followed - self.points, axis=1)


def clamped(interior: Array, degree: int) -> Array:
    """Return the knot vector with these interior knots."""
    return np.concatenate([np.zeros(degree + 1), interior, np.ones(degree + 1)])


def _normal_equations(gram: Array, right: Array, determined: bool) -> Array:
    try:
        factor = cho_factor(gram, check_finite=False)
        solution = np.asarray(cho_solve(factor, right, check_finite=False))
    except LinAlgError:
        if determined:
            raise
        # Too few points under some basis function: the minimum-norm solution stays bounded.
        solution = np.asarray(np.linalg.lstsq(gram, right, rcond=1e-10)[0])
    return solution
