"""Displacement of a curve in its own spline space, which keeps its knots and weights and, where it can, its size."""

from __future__ import annotations

import numpy as np

from teachpath.exchange import insert_knot
from teachpath.nurbs import Curve
from teachpath.records import Array

# Weight of second differences of the moves of control points: without it, those that hardly reach any of the points
# are moved by metres for a millimetre there, and the curve swings in between.
SMOOTHNESS = 0.03
MIN_POINTS_PER_SPAN = 3  # of a span that gets another knot


def displaced(curve: Curve, u: Array, displacements: Array, bound: float, most: int) -> tuple[Curve, float]:
    """Move points of a curve, with as few additional knots as the bound needs.

    Control points are moved by least squares, the first and the last exactly, and alike where the points leave it open.
    No displacement gives the same curve, and the same one everywhere moves it as it is.

    Args:
        curve: with n control points.
        u: (m,) parameters, from 0 to 1.
        displacements: (m, 3) [m].
        bound: largest distance [m] from the displaced points.
        most: control points the result may have, unless the curve has more; fewer where its spans hold few points.

    Returns:
        the curve, and its largest distance [m] from the displaced points.
    """
    while True:
        moved = _moved(curve, u, displacements)
        off = np.linalg.norm(moved(u) - curve(u) - displacements, axis=1)
        missed, span = float(off.max()), _worst_span(curve, u, off)
        if missed <= bound or len(curve.control_points) >= most or span is None:
            return moved, missed
        curve = insert_knot(curve, span)


def _moved(curve: Curve, u: Array, displacements: Array) -> Curve:
    count = len(curve.control_points)
    basis = Curve(curve.degree, curve.knots, np.eye(count), curve.weights)(u)  # (m, n)
    moves = np.zeros((count, displacements.shape[1]))
    moves[[0, -1]] = displacements[[0, -1]]
    rows = np.concatenate([basis, SMOOTHNESS * np.diff(np.eye(count), 2, axis=0)])
    wanted = np.concatenate([displacements, np.zeros((count - 2, displacements.shape[1]))])
    moves[1:-1] = np.linalg.lstsq(rows[:, 1:-1], wanted - rows @ moves, rcond=None)[0]
    return Curve(curve.degree, curve.knots, curve.control_points + moves, curve.weights)


def _worst_span(curve: Curve, u: Array, off: Array) -> float | None:
    """Return the middle of the span, among those with enough points, whose point is farthest off; None of none."""
    spans = np.unique(curve.knots)
    left = np.clip(np.searchsorted(spans, u, side="right") - 1, 0, len(spans) - 2)
    enough = np.bincount(left)[left] >= MIN_POINTS_PER_SPAN
    if not enough.any():
        return None
    worst = left[int(np.argmax(np.where(enough, off, -1.0)))]
    return float((spans[worst] + spans[worst + 1]) / 2)
