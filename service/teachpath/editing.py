"""Editing of curves: validation, operations that preserve the shape, and the difference between two curves.

Piegl & Tiller, The NURBS Book, chapter 5: knot insertion, knot removal and degree elevation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import scipy

from teachpath import exchange
from teachpath.errors import UnusableInput
from teachpath.exchange import SAME_SHAPE_TOLERANCE
from teachpath.lengths import describe_lengths
from teachpath.nurbs import Array, Curve
from teachpath.records import ControlPointChange, Difference

MAX_COORDINATE: Final = 10.0  # m, of a control point from the robot's base
WEIGHT_LIMITS: Final = (1e-3, 1e3)
MAX_CONTROL_POINTS: Final = 500
MAX_DEGREE: Final = 7
MAX_REMOVAL_TOLERANCE: Final = 0.1  # m, that a removed knot may be allowed to move the curve
MIN_KNOT_SPACING: Final = 1e-6  # between knots; a new knot nearer to another one raises its multiplicity
MIN_CHANGE: Final = 1e-9  # m, by which a control point counts as moved
MEASURED_INTERVALS: Final = 400  # of the parameter, at which two curves are compared


@dataclass(frozen=True, eq=False)
class EditResult:
    """A curve after an operation, and its largest distance [m] from the curve before, measured at 401 parameters.

    Attributes:
        curve: after the operation.
        deviation: its largest distance from the curve before, measured at 401 parameters [m].
    """

    curve: Curve
    deviation: float


def check_editable(curve: Curve) -> Curve:
    """Return a curve that can be edited, saved and planned.

    Raises:
        UnusableInput: it is not in space, too long, too far away, or a weight is outside its limits.
    """
    points, weights = curve.control_points, curve.weights
    if points.shape[1] != 3:
        raise UnusableInput(f"control points have {points.shape[1]} coordinates; a path has 3 (x, y, z)")
    if len(points) > MAX_CONTROL_POINTS:
        raise UnusableInput(f"{len(points)} control points are over the limit of {MAX_CONTROL_POINTS}; remove knots")
    worst = int(np.argmax(np.abs(points).max(axis=1)))
    if np.abs(points[worst]).max() > MAX_COORDINATE:
        raise UnusableInput(
            f"control point {worst + 1} is {np.abs(points[worst]).max():.4g} m away, limit {MAX_COORDINATE:g}; "
            "use metres"
        )
    wrong = np.flatnonzero((weights < WEIGHT_LIMITS[0]) | (weights > WEIGHT_LIMITS[1]))
    if len(wrong):
        raise UnusableInput(
            f"the weight of control point {wrong[0] + 1} is {weights[wrong[0]]:.4g}, limits {WEIGHT_LIMITS[0]:g} to "
            f"{WEIGHT_LIMITS[1]:g}; move the control point instead"
        )
    inner, counts = np.unique(curve.knots[curve.degree + 1 : -curve.degree - 1], return_counts=True)
    if np.any(counts > curve.degree):
        u = inner[int(np.argmax(counts))]
        raise UnusableInput(
            f"u = {u:g} is a knot {counts.max()} times; more than degree {curve.degree} tears the curve apart"
        )
    if np.ptp(points, axis=0).max() < SAME_SHAPE_TOLERANCE:
        raise UnusableInput("all control points lie in one place; a path leads from one place to another")
    return curve


def insert_knot(curve: Curve, u: float) -> EditResult:
    """Add a knot at `u`, and with it a control point; the shape stays. Raises UnusableInput."""
    if len(curve.control_points) >= MAX_CONTROL_POINTS:
        raise UnusableInput(f"the curve has {MAX_CONTROL_POINTS} control points, which is the limit")
    nearest = float(curve.knots[np.argmin(np.abs(curve.knots - u))])
    return _measured(
        curve, exchange.insert_knot(curve, nearest if abs(nearest - u) < MIN_KNOT_SPACING else u), SAME_SHAPE_TOLERANCE
    )


def remove_knot(curve: Curve, u: float, *, tolerance: float = SAME_SHAPE_TOLERANCE) -> EditResult:
    """Take out one knot at `u` when that moves the curve by at most `tolerance` [m]. Raises UnusableInput."""
    if not 0 < tolerance <= MAX_REMOVAL_TOLERANCE:
        raise UnusableInput(f"a tolerance of {tolerance:g} m is outside 0 to {MAX_REMOVAL_TOLERANCE:g}")
    return _measured(curve, check_editable(exchange.remove_knot(curve, u, tolerance=tolerance)), tolerance)


def elevate_degree(curve: Curve) -> EditResult:
    """Raise the degree by one; the shape stays.

    In degree p + 1 with every knot once more, the curve is still a spline: it is found by interpolation at the
    Greville abscissae, one for each control point, which is exact.

    Raises:
        UnusableInput: the degree is the highest, or there would be too many control points.
    """
    if curve.degree >= MAX_DEGREE:
        raise UnusableInput(f"degree {curve.degree} is the highest; insert knots for more control points")
    degree = curve.degree + 1
    distinct, counts = np.unique(curve.knots, return_counts=True)
    knots = np.repeat(distinct, counts + 1)
    count = len(knots) - degree - 1
    if count > MAX_CONTROL_POINTS:
        raise UnusableInput(
            f"degree {degree} would need {count} control points, limit {MAX_CONTROL_POINTS}; remove knots"
        )
    greville = np.array([knots[i + 1 : i + degree + 1].mean() for i in range(count)])
    greville[[0, -1]] = 0.0, 1.0
    points, weights = curve.derivatives(greville, 0)[0], _weight(curve, greville)
    full = scipy.interpolate.make_interp_spline(
        greville, np.column_stack([points * weights[:, None], weights]), k=degree, t=knots
    ).c
    raised = Curve(degree, knots, full[:, :-1] / full[:, -1:], full[:, -1])
    return _measured(curve, check_editable(raised), SAME_SHAPE_TOLERANCE)


def difference(first: Curve, second: Curve) -> Difference:
    """Measure the distance of two curves as sets of points, and list the control points that differ."""
    one, _ = _evenly(first)
    two, s_two = _evenly(second)
    there, back = _distances(two, one), _distances(one, two)
    farthest = int(np.argmax(there))
    s = float(s_two[farthest]) if there[farthest] >= back.max() else float(s_two[_nearest(two, one[np.argmax(back)])])
    largest, mean = float(max(there.max(), back.max())), float((there.mean() + back.mean()) / 2)
    moved = _moved(first, second)
    return Difference(largest, mean, s, moved, _in_words(largest, mean, s, moved))


def _weight(curve: Curve, u: Array) -> Array:
    """Evaluate the denominator of a rational curve: the spline of its weights."""
    plain = Curve(curve.degree, curve.knots, curve.weights[:, None], np.ones(len(curve.weights)))
    return np.asarray(plain(u)[:, 0])


def _measured(before: Curve, after: Curve, tolerance: float) -> EditResult:
    at = np.linspace(0.0, 1.0, MEASURED_INTERVALS + 1)
    deviation = float(np.linalg.norm(after(at) - before(at), axis=1).max())
    if not deviation <= tolerance:
        moved, most = describe_lengths(deviation, tolerance)
        raise UnusableInput(
            f"this would move the curve by {moved}, more than {most}, because its knots or weights are too uneven; "
            "even them out first"
        )
    return EditResult(after, deviation)


def _evenly(curve: Curve) -> tuple[Array, Array]:
    """Return points at even arc lengths, and the arc lengths [m]."""
    fine = curve(np.linspace(0.0, 1.0, 10 * MEASURED_INTERVALS + 1))
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(fine, axis=0), axis=1))])
    s = np.linspace(0.0, along[-1], MEASURED_INTERVALS + 1)
    return np.column_stack([np.interp(s, along, fine[:, axis]) for axis in range(3)]), s


def _distances(points: Array, line: Array) -> Array:
    """Return the distance of each point from a polyline (m, 3)."""
    start, step = line[:-1], np.diff(line, axis=0)
    square = np.maximum((step**2).sum(axis=1), 1e-30)
    off = points[:, None] - start  # (n, m - 1, 3)
    share = np.clip((off * step).sum(axis=2) / square, 0.0, 1.0)
    off -= share[..., None] * step
    return np.asarray(np.sqrt((off**2).sum(axis=2).min(axis=1)))


def _nearest(points: Array, point: Array) -> int:
    return int(np.argmin(((points - point) ** 2).sum(axis=1)))


def _moved(first: Curve, second: Curve) -> tuple[ControlPointChange, ...] | None:
    """Bring the first curve onto the second's knots, and compare control point by control point."""
    while first.degree < second.degree:
        first = elevate_degree(first).curve
    if first.degree > second.degree:
        return None
    for u in np.unique(second.knots)[1:-1]:
        while np.sum(first.knots == u) < np.sum(second.knots == u):
            first = exchange.insert_knot(first, float(u))
    if not np.array_equal(first.knots, second.knots):
        return None
    off = np.linalg.norm(second.control_points - first.control_points, axis=1)
    pairs = np.column_stack([first.weights, second.weights])
    changed = np.flatnonzero((off > MIN_CHANGE) | (np.abs(np.diff(pairs, axis=1)[:, 0]) > MIN_CHANGE))
    return tuple(
        ControlPointChange(int(i) + 1, float(off[i]), (float(pairs[i, 0]), float(pairs[i, 1]))) for i in changed
    )


def _in_words(largest: float, mean: float, s: float, moved: tuple[ControlPointChange, ...] | None) -> str:
    if largest < SAME_SHAPE_TOLERANCE:
        shape = "the shape is the same"
    else:
        apart, usual = describe_lengths(largest, mean)
        shape = f"they lie up to {apart} apart (at s = {s:.3f} m) and {usual} on average"
    if moved is None:
        return f"{shape}; the control points have no counterparts, because knots were removed"
    if not moved:
        return f"{shape}; no control point was moved"
    numbers = ", ".join(str(m.number) for m in moved[:12]) + (", ..." if len(moved) > 12 else "")
    return f"{shape}; changed: control point{'s' if len(moved) > 1 else ''} {numbers} of the second"
