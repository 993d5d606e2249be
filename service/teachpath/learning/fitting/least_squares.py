"""Least squares with given knots and fixed end points (The NURBS Book, section 9.4.1)."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import LinAlgError, solveh_banded

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
        self.points: Array = points
        self.u: Array = u
        self.degree: int = degree
        self._ends = points[[0, -1]] if ends is None else ends

    def solve(self, interior: Array, *, determined: bool = False) -> tuple[Array, Array]:
        """Return control points (n, d) and the distance of each point from the curve at its parameter (m,).

        Args:
            interior: knots between 0 and 1.
            determined: refuse knots for which the points do not determine every control point.

        Raises:
            LinAlgError: they do not, and it was asked for.
        """
        knots = clamped(interior, self.degree)
        count = len(knots) - self.degree - 1
        basis = np.asarray(BSpline.construct_fast(knots, np.eye(count), self.degree)(self.u))  # (m, n)
        control = np.empty((count, self.points.shape[1]))
        control[0], control[-1] = self._ends
        if count > 2:
            inner = basis[:, 1:-1]
            right = np.einsum("mi,md->id", inner, self.points - _values(basis[:, [0, -1]], self._ends))
            # Products of few columns: a matrix product would round differently with another number of threads.
            bands = np.zeros((min(self.degree + 1, count - 2), count - 2))
            for k in range(len(bands)):
                bands[k, : count - 2 - k] = np.einsum("mi,mi->i", inner[:, : count - 2 - k], inner[:, k:])
            control[1:-1] = _normal_equations(bands, right, determined)
        return control, _lengths(_values(basis, control) - self.points)


def clamped(interior: Array, degree: int) -> Array:
    """Return the knot vector with these interior knots."""
    return np.concatenate([np.zeros(degree + 1), interior, np.ones(degree + 1)])


def _values(basis: Array, control: Array) -> Array:
    return np.asarray(np.einsum("mi,id->md", basis, control))


def _lengths(offsets: Array) -> Array:
    return np.asarray(np.sqrt(np.einsum("md,md->m", offsets, offsets)))


def _normal_equations(bands: Array, right: Array, determined: bool) -> Array:
    """Solve for (n, d) from the diagonals of a symmetric matrix (p + 1, n), the main one first."""
    try:
        solution = np.asarray(solveh_banded(bands, right, lower=True, check_finite=False))
    except LinAlgError:
        if determined:
            raise
        # Too few points under some basis function: the minimum-norm solution stays bounded.
        lower = sum(np.diag(band[: len(band) - k], -k) for k, band in enumerate(bands))
        gram = lower + np.tril(lower, -1).T
        solution = np.asarray(np.linalg.lstsq(gram, right, rcond=1e-10)[0])
    return solution
