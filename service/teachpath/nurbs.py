"""The curve: a clamped NURBS, evaluated and differentiated for whole arrays of parameters.

Piegl & Tiller, The NURBS Book (2nd ed., Springer 1997); Aleotti & Caselli 2005, eq. (4) and (5).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb

import numpy as np
import scipy
from numpy.typing import NDArray

from teachpath.errors import UnusableInput

Array = NDArray[np.float64]
Matrix = np.ndarray[tuple[int, int], np.dtype[np.float64]]  # an array of rows


@dataclass(frozen=True, eq=False)
class Curve:
    """A clamped NURBS on the parameter range [0, 1].

    Attributes:
        degree: p, 1 to 7.
        knots: (n + p + 1,) non-decreasing, p + 1 times 0 first and p + 1 times 1 last.
        control_points: (n, d) [m], or of a curve of quaternions (n, 4).
        weights: (n,) positive.
    """

    degree: int
    knots: Array
    control_points: Matrix
    weights: Array

    def __post_init__(self) -> None:
        for name in ("knots", "control_points", "weights"):
            value = np.array(getattr(self, name), dtype=np.float64)
            value.flags.writeable = False
            object.__setattr__(self, name, value)
        _check(self)

    def __call__(self, u: Array | float, order: int = 0) -> Array:
        """Evaluate the curve or a derivative of it.

        Args:
            u: (m,) or scalar parameters in [0, 1]; values outside are clipped.
            order: 0 for the point, k for the k-th derivative with respect to u.

        Returns:
            (m, d) or (d,) [m per unit of u to the power of order].
        """
        return self.derivatives(u, order)[order]

    def derivatives(self, u: Array | float, order: int) -> list[Array]:
        """Evaluate the curve and its first `order` derivatives (The NURBS Book, eq. (4.8))."""
        at = np.clip(np.asarray(u, dtype=np.float64), 0.0, 1.0)
        homogeneous = np.column_stack([self.control_points * self.weights[:, None], self.weights])
        spline = scipy.interpolate.BSpline(self.knots, homogeneous, self.degree)
        raw = [np.asarray(spline(at, nu=k)) if k <= self.degree else np.zeros((*at.shape, homogeneous.shape[1]))
               for k in range(order + 1)]  # fmt: skip
        weight = [r[..., -1:] for r in raw]
        results: list[Array] = []
        for k in range(order + 1):
            numerator = raw[k][..., :-1]
            for i in range(1, k + 1):
                numerator = numerator - comb(k, i) * weight[i] * results[k - i]
            results.append(numerator / weight[0])
        return results

    def length(self) -> float:
        """Return the arc length [m], by Gauss-Legendre quadrature on every knot span."""
        nodes, weights = np.polynomial.legendre.leggauss(16)
        spans = np.unique(self.knots)
        half = np.diff(spans) / 2
        u = (spans[:-1] + half)[:, None] + half[:, None] * nodes  # (spans, 16)
        speed = np.linalg.norm(self(u.ravel(), 1), axis=1).reshape(u.shape)
        return float(np.sum(half * (speed @ weights)))


def unit_quaternions(curve: Curve, u: Array | float) -> Array:
    """Evaluate a curve of quaternions: (m, 4) or (4,) of unit length, neighbours on one half of the sphere.

    Args:
        curve: with control points (n, 4), no quaternions themselves.
        u: (m,) or scalar parameters in [0, 1].
    """
    at = curve(u)
    return np.asarray(at / np.linalg.norm(at, axis=-1, keepdims=True))


def _check(curve: Curve) -> None:
    n, p = len(curve.control_points), curve.degree
    if not 1 <= p <= 7:
        raise UnusableInput(f"a NURBS of degree {p} is outside 1 to 7")
    if curve.control_points.ndim != 2 or n < p + 1:
        raise UnusableInput(f"a NURBS of degree {p} needs at least {p + 1} control points, got {n}")
    if len(curve.knots) != n + p + 1:
        raise UnusableInput(f"{n} control points of degree {p} need {n + p + 1} knots, got {len(curve.knots)}")
    if len(curve.weights) != n:
        raise UnusableInput(f"{n} control points need {n} weights, got {len(curve.weights)}")
    if not all(np.all(np.isfinite(a)) for a in (curve.knots, curve.control_points, curve.weights)):
        raise UnusableInput("a NURBS has a knot, control point or weight that is not finite")
    if np.any(curve.weights <= 0):
        raise UnusableInput(f"weight {int(np.argmin(curve.weights))} is {curve.weights.min():g}; weights are positive")
    if np.any(np.diff(curve.knots) < 0):
        raise UnusableInput("the knots of a NURBS must not decrease")
    if np.any(curve.knots[: p + 1] != 0) or np.any(curve.knots[-p - 1 :] != 1):
        raise UnusableInput(f"a clamped NURBS of degree {p} begins with {p + 1} knots 0 and ends with {p + 1} knots 1")
