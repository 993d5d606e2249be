"""Global approximation of points within an error bound, by removing knots from their polygon.

Piegl & Tiller, The NURBS Book (2nd ed., Springer 1997), algorithm A9.10, which the publication's library calls
`globalApproxErrBnd`. All weights are 1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline
from scipy.linalg import LinAlgError
from scipy.spatial import cKDTree

from teachpath.learning.fitting.knot_removal import remove_knots
from teachpath.learning.fitting.least_squares import LeastSquares
from teachpath.learning.fitting.polyline import nearest_on_polyline
from teachpath.learning.resampling import arc_lengths
from teachpath.nurbs import Curve
from teachpath.records import Array

SAMPLES_PER_GAP = 4  # of the curve between two fitted points, at which its distance from their polygon is watched
BOUND_GROWTH = 2.0  # factor on a bound that takes too many control points
BOUND_RATIO = 1.2  # ratio of the bound that is found to one that takes too many


@dataclass(frozen=True, eq=False)
class GlobalApproximation:
    """A curve and the bound [m] that it keeps."""

    curve: Curve
    bound: float


def approximate_from_polygon(
    points: Array, bound: float, *, degree: int, most: int | None = None
) -> GlobalApproximation:
    """Approximate ordered points from their polygon: fewer knots, a higher degree, fewer knots again (A9.10).

    Neither is a point farther than the bound from the curve, nor a part of the curve from the polygon. The algorithm as
    published has only the first in view, and its least-squares fit breaks both where knots outnumber points. Here a fit
    that does is passed over: the curve before it is raised in degree as it is (A5.9).

    Args:
        points: (n, d) [m], at least two different ones; the curve begins and ends on the first and the last.
        bound: largest distance [m]; at 0 the curve is the polygon.
        degree: of the curve.
        most: largest number of control points, for which the bound is widened where it has to be; None = without limit.
    """
    polygon = _Polygon(points)
    found = polygon.approximated(bound, degree)
    room = max(most or len(found.c), degree + 1)
    if len(found.c) > room:
        bound, found = _widened(polygon, bound, degree, room)
    return GlobalApproximation(Curve(degree, found.t, found.c, np.ones(len(found.c))), bound)


def _widened(polygon: _Polygon, bound: float, degree: int, room: int) -> tuple[float, BSpline]:
    """Return nearly the least bound for which so many control points suffice, and the spline within it."""
    least, bound = bound, max(BOUND_GROWTH * bound, 1e-6)
    while len((found := polygon.approximated(bound, degree)).c) > room:
        least, bound = bound, BOUND_GROWTH * bound
    while bound > BOUND_RATIO * least > 0:
        between = float(np.sqrt(least * bound))
        closer = polygon.approximated(between, degree)
        if len(closer.c) > room:
            least = between
        else:
            bound, found = between, closer
    return bound, found


@dataclass(frozen=True, eq=False)
class _Errors:
    """How far a curve and the fitted points are from each other, at parameters in ascending order.

    Attributes:
        at: (k,) parameters, of points projected on the curve and of samples of the curve.
        errors: (k,) [m], no less than the distances of the points from the curve, and of the samples from the polygon.
        projected: (n,) parameters of the points.
    """

    at: Array
    errors: Array
    projected: Array


class _Polygon:
    """The polygon of the points to approximate; repeated ones are passed over."""

    def __init__(self, points: Array) -> None:
        lengths = arc_lengths(points)
        forward = np.concatenate([[True], np.diff(lengths) > 1e-12 * lengths[-1]])
        self.points = np.concatenate([points[forward][:-1], points[-1:]])
        self.at = lengths[forward] / lengths[-1]
        self.at[-1] = 1.0
        self._tree = cKDTree(self.points)
        gaps = np.diff(self.at)[:, None] * np.arange(SAMPLES_PER_GAP) / SAMPLES_PER_GAP
        self._samples = np.append((self.at[:-1, None] + gaps).ravel(), 1.0)

    def approximated(self, bound: float, degree: int) -> BSpline:
        """Return the spline of this degree within the bound."""
        return self._smoothed(self._reduced(bound), bound, degree)

    def _reduced(self, bound: float) -> BSpline:
        """Return the polygon without the vertices that the bound does not need."""
        knots = np.concatenate([[0.0], self.at, [1.0]])
        return BSpline(*remove_knots(1, knots, self.points, self.at, np.zeros(len(self.at)), bound), 1)

    def _smoothed(self, spline: BSpline, bound: float, degree: int) -> BSpline:
        """Raise the degree step by step, with fewer knots at each."""
        while spline.k < degree:
            raised = _raised(spline)
            spline = self._without_knots(self._refitted(raised, bound) or raised, bound)
        # As published, a last fit with the knots that are left makes room for the removal of more.
        refitted = self._refitted(spline, bound)
        return spline if refitted is None else self._without_knots(refitted, bound)

    def _refitted(self, spline: BSpline, bound: float) -> BSpline | None:
        """Fit the points anew with the knots of the spline; None where that is impossible or breaks the bound."""
        at = self._errors(spline).projected
        at[0], at[-1] = 0.0, 1.0
        order = np.argsort(at, kind="stable")
        problem = LeastSquares(self.points[order], at[order], spline.k, ends=self.points[[0, -1]])
        try:
            control, _ = problem.solve(spline.t[spline.k + 1 : -spline.k - 1], determined=True)
        except LinAlgError:
            return None
        refitted = BSpline(spline.t, control, spline.k)
        return refitted if self._errors(refitted).errors.max() <= bound else None

    def _without_knots(self, spline: BSpline, bound: float) -> BSpline:
        found = self._errors(spline)
        return BSpline(*remove_knots(spline.k, spline.t, spline.c, found.at, found.errors, bound), spline.k)

    def _errors(self, spline: BSpline) -> _Errors:
        """Measure how far the curve and the points are from each other."""
        samples = spline(self._samples)
        _, where = nearest_on_polyline(cKDTree(samples), samples, self.points)
        projected = np.interp(where, np.arange(len(samples)), self._samples)
        of_points = np.linalg.norm(spline(projected) - self.points, axis=1)
        of_samples, _ = nearest_on_polyline(self._tree, self.points, samples)
        at = np.concatenate([projected, self._samples])
        order = np.argsort(at, kind="stable")
        return _Errors(at[order], np.concatenate([of_points, of_samples])[order], projected)


def _raised(spline: BSpline) -> BSpline:
    """Raise the degree of a spline by one without changing it (A5.9), by interpolation at Greville's abscissae."""
    degree = spline.k + 1
    knots = np.sort(np.concatenate([spline.t, np.unique(spline.t)]))
    inner = np.lib.stride_tricks.sliding_window_view(knots[1:-1], degree)
    at = inner.mean(axis=1)
    at[0], at[-1] = 0.0, 1.0
    return make_interp_spline(at, spline(at), k=degree, t=knots)
