"""Least-squares fit of a NURBS to points within an error bound, with knots where the error requires them.

Piegl & Tiller, The NURBS Book, section 9.4.1 (least squares with fixed end points). All weights are 1; an operator may
change them later.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from teachpath.learning.fitting.least_squares import LeastSquares, clamped
from teachpath.learning.fitting.polyline import nearest_on_polyline
from teachpath.learning.resampling import arc_lengths
from teachpath.nurbs import Curve
from teachpath.records import Array

MIN_POINTS_PER_SPAN = 4  # so that the points determine every control point (Schoenberg & Whitney)
HALF_SHARE = (
    0.5 - 1e-6
)  # of the error of a span, at which it is split; not exactly 0.5, where rounding would decide for symmetric paths
MAX_GAP = 0.02  # between two points, as a share of the length
MAX_POINTS_FOR_REMOVAL = 5000  # above which no knot is removed
CURVE_SAMPLES = 2000  # points of the polyline that represents a curve while distances are measured


@dataclass(frozen=True, eq=False)
class Approximation:
    """A curve, and the largest distance [m] of a fitted point from the curve at the parameter of the point."""

    curve: Curve
    largest: float


def approximate(
    points: Array, bound: float, *, degree: int, most: int, span: int = MIN_POINTS_PER_SPAN, at: Array | None = None
) -> Approximation:
    """Fit a NURBS to ordered points, with as few knots as the bound allows.

    The fit starts without interior knots, splits every span that holds a point beyond the bound, and finally removes
    each knot that is not needed. It stops beyond the bound when it reaches `most` control points or `span` points per
    knot span. Where points are far from each other, points between them are followed, too: no part of the curve is
    farther from the given points than the bound, or what was reached of it, and half the gap between them.

    Args:
        points: (n, d) [m] in the order of the path; the curve begins and ends exactly on the first and last.
        bound: largest distance of a point from the curve [m].
        degree: of the curve; lowered when there are too few points for it.
        most: largest number of control points.
        span: least number of points in a knot span.
        at: (n,) parameters of the points, from 0 to 1; None = shares of the arc length.
    """
    if at is None:
        points = _without_wide_gaps(points)
    s = arc_lengths(points) if at is None else at
    forward = np.concatenate([[True], np.diff(s) > 1e-12 * s[-1]])
    points, s = np.concatenate([points[forward][:-1], points[-1:]]), s[forward]
    u = s / s[-1]
    u[-1] = 1.0
    degree = max(1, min(degree, len(points) - 1))
    problem = LeastSquares(points, u, degree)
    interior = np.empty(0)
    errors = problem.solve(interior)[1]
    while errors.max() > bound:
        room = most - degree - 1 - len(interior)
        added = _splits(u, interior, errors, bound, span)[: max(room, 0)]
        if not added:
            break
        interior = np.sort(np.concatenate([interior, added]))
        errors = problem.solve(interior)[1]
    if errors.max() <= bound and len(points) <= MAX_POINTS_FOR_REMOVAL:
        interior = _pruned(problem, interior, bound)
    control, errors = problem.solve(interior)
    curve = Curve(degree, clamped(interior, degree), control, np.ones(len(control)))
    return Approximation(curve, float(errors.max()))


def distances_to_curve(curve: Curve, points: Array) -> Array:
    """Return the distance of every point from the nearest point of the curve: (n,) [m]."""
    return CurveDistance(curve)(points)


class CurveDistance:
    """The distance of points from one curve, for many sets of points.

    The curve is sampled densely and taken for a polyline; the two segments beside the nearest sample are measured.
    """

    def __init__(self, curve: Curve) -> None:
        self._samples = curve(np.linspace(0.0, 1.0, max(CURVE_SAMPLES, 64 * len(curve.control_points)) + 1))
        self._tree = cKDTree(self._samples)

    def __call__(self, points: Array) -> Array:
        """Return the distance of every point from the curve: (n,) [m]."""
        return nearest_on_polyline(self._tree, self._samples, points)[0]


def _without_wide_gaps(points: Array) -> Array:
    """Put points on the straight lines between points that are far from each other."""
    gaps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    pieces = np.maximum(np.ceil(gaps / max(MAX_GAP * gaps.sum(), 1e-300)).astype(int), 1)
    if pieces.max(initial=1) == 1:
        return points
    begin = np.repeat(np.arange(len(pieces)), pieces)
    share = np.concatenate([np.arange(count) / count for count in pieces])[:, None]
    return np.concatenate([(1 - share) * points[begin] + share * points[begin + 1], points[-1:]])


def _splits(u: Array, interior: Array, errors: Array, bound: float, span: int) -> list[float]:
    """Return a knot for every span beyond the bound, at the span's error-weighted median; worst span first."""
    edges = np.concatenate([[0.0], interior, [1.0]])
    begins = np.searchsorted(u, edges[:-1], side="left")
    ends = np.append(begins[1:], len(u))
    found: list[tuple[float, float]] = []
    for begin, end in zip(begins, ends, strict=True):
        worst = errors[begin:end].max(initial=0.0)
        if worst <= bound or end - begin < 2 * span:
            continue
        weight = np.cumsum(np.square(errors[begin:end]))
        middle = begin + int(np.searchsorted(weight, weight[-1] * HALF_SHARE))
        middle = min(max(middle, begin + span), end - span)
        found.append((-float(worst), float(u[middle - 1] + u[middle]) / 2))
    return [knot for _, knot in sorted(found)]


def _pruned(problem: LeastSquares, interior: Array, bound: float) -> Array:
    """Remove knots one at a time while the bound holds, the one that costs least first."""
    while len(interior):
        fewer = [np.delete(interior, k) for k in range(len(interior))]
        largest = np.array([problem.solve(knots)[1].max() for knots in fewer])
        # Of errors that differ by rounding only the first is taken: a symmetric path gives the same in every frame.
        best = int(np.argmax(largest <= largest.min() * (1 + 1e-6)))
        if largest[best] > bound:
            break
        interior = fewer[best]
    return interior
