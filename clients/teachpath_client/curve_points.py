"""Points of a curve as the station sends it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from teachpath_client.models import Curve


def curve_points(curve: Curve, count: int) -> NDArray[np.float64]:
    """Return points (count, d) of a NURBS at even parameters from 0 to 1, both ends included.

    By de Boor's algorithm on the homogeneous control points: every step blends neighbours at the shares of the knots
    between which the parameter lies.
    """
    degree, knots = curve.degree, np.array(curve.knots)
    weights = np.array(curve.weights)[:, None]
    controls = np.hstack([np.array(curve.control_points) * weights, weights])
    parameters = np.linspace(0.0, 1.0, count)
    spans = np.clip(np.searchsorted(knots, parameters, side="right") - 1, degree, len(controls) - 1)
    points = controls[spans[:, None] + np.arange(-degree, 1)]
    for step in range(1, degree + 1):
        at = spans[:, None] + np.arange(step - degree, 1)  # of the knots where each blend begins
        begin, end = knots[at], knots[at + degree + 1 - step]
        share = ((parameters[:, None] - begin) / (end - begin))[..., None]
        points = (1.0 - share) * points[:, :-1] + share * points[:, 1:]
    return np.asarray(points[:, 0, :-1] / points[:, 0, -1:])
