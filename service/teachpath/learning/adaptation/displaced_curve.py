"""Displacement of a curve in its own spline space, which keeps its knots and weights and, where it can, its size."""

from __future__ import annotations

import numpy as np

from teachpath.exchange import insert_knot
from teachpath.nurbs import Curve
from teachpath.records import Array


def displaced(curve: Curve, u: Array, displacements: Array, bound: float, most: int) -> tuple[Curve, float]:
    """Move points of a curve, with as few additional knots as the bound needs.

    Control points are moved by least squares, the first and the last exactly. No displacement gives the same curve.

    Args:
        curve: with n control points.
        u: (m,) parameters, from 0 to 1.
        displacements: (m, 3) [m].
        bound: largest distance [m] from the displaced points.
        most: control points the result may have, unless the curve has more.

    Returns:
        the curve, and its largest distance [m] from the displaced points.
    """
    while True:
        moved = _moved(curve, u, displacements)
        off = np.linalg.norm(moved(u) - curve(u) - displacements, axis=1)
        worst = int(np.argmax(off))
        if off[worst] <= bound or len(curve.control_points) >= most:
            return moved, float(off[worst])
        curve = insert_knot(curve, _middle_of_span(curve, float(u[worst])))


def _moved(curve: Curve, u: Array, displacements: Array) -> Curve:
    count = len(curve.control_points)
    basis = Curve(curve.degree, curve.knots, np.eye(count), curve.weights)(u)  # (m, n)
    moves = np.zeros((count, displacements.shape[1]))
    moves[[0, -1]] = displacements[[0, -1]]
    moves[1:-1] = np.linalg.lstsq(basis[:, 1:-1], displacements - basis @ moves, rcond=None)[0]
    return Curve(curve.degree, curve.knots, curve.control_points + moves, curve.weights)


def _middle_of_span(curve: Curve, u: float) -> float:
    spans = np.unique(curve.knots)
    left = int(np.clip(np.searchsorted(spans, u, side="right") - 1, 0, len(spans) - 2))
    return float((spans[left] + spans[left + 1]) / 2)
