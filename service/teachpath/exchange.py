"""The door to geomdl: knot insertion and removal that preserve the shape, and geomdl's JSON exchange format.

Piegl & Tiller, The NURBS Book, section 5.2 (knot insertion) and 5.4 (knot removal).
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

from teachpath.errors import UnusableInput
from teachpath.lengths import describe_lengths
from teachpath.nurbs import Array, Curve

if TYPE_CHECKING:
    from geomdl import NURBS

SAME_SHAPE_TOLERANCE = 1e-6  # m, distance that a removed knot may move the curve


def to_geomdl(curve: Curve) -> NURBS.Curve:
    """Return the curve as geomdl's own, rational one."""
    from geomdl import NURBS

    converted = NURBS.Curve(normalize_kv=False)
    converted.degree = curve.degree
    converted.ctrlptsw = np.column_stack([curve.control_points * curve.weights[:, None], curve.weights]).tolist()
    converted.knotvector = curve.knots.tolist()
    return converted


def from_geomdl(converted: NURBS.Curve) -> Curve:
    """Return geomdl's rational curve as ours.

    Raises:
        UnusableInput: it is no clamped NURBS on [0, 1] of degree 1 to 7.
    """
    return Curve(
        converted.degree, np.array(converted.knotvector), np.array(converted.ctrlpts), np.array(converted.weights)
    )


def insert_knot(curve: Curve, u: float) -> Curve:
    """Add a knot at parameter `u`, and with it a control point; the shape stays.

    Raises:
        UnusableInput: `u` is not inside (0, 1), or is a knot as often as the degree already.
    """
    if not 0 < u < 1:
        raise UnusableInput(f"a knot at u = {u:g} is outside the curve; choose 0 < u < 1")
    if int(np.sum(curve.knots == u)) >= curve.degree:
        raise UnusableInput(
            f"u = {u:g} is a knot {curve.degree} times already, as often as degree {curve.degree} allows"
        )
    from geomdl import operations  # here, because a station that starts has no curve to edit

    return from_geomdl(operations.insert_knot(to_geomdl(curve), [float(u)], [1]))


def remove_knot(curve: Curve, u: float, *, tolerance: float = SAME_SHAPE_TOLERANCE) -> Curve:
    """Take out one knot at parameter `u`, and with it a control point.

    Args:
        curve: the curve; it is not changed.
        u: an inner knot.
        tolerance: distance by which the curve may move [m].

    Raises:
        UnusableInput: `u` is no inner knot, or the curve would move farther than `tolerance`.
    """
    if not 0 < u < 1 or not np.any(curve.knots == u):
        inner = ", ".join(f"{knot:.4g}" for knot in np.unique(curve.knots)[1:-1]) or "none"
        raise UnusableInput(f"u = {u:g} is no inner knot of the curve; it has {inner}")
    fewer = _without(curve, u)
    at = np.linspace(0.0, 1.0, 1001)
    moved = float(np.linalg.norm(fewer(at) - curve(at), axis=1).max())
    if not moved <= tolerance:
        far, most = describe_lengths(moved, tolerance)
        raise UnusableInput(
            f"without the knot at u = {u:g} the curve moves by {far}, more than {most}; move the control points instead"
        )
    return fewer


def _without(curve: Curve, u: float) -> Curve:
    """Return the curve without the knot `u`, by least squares; its ends stay.

    geomdl's own removal changes the shape even of a knot just inserted (NURBS-Python issue 188), so insertion, which
    is linear in the homogeneous control points, is inverted by least squares.
    """
    knots = np.delete(curve.knots, int(np.argmax(curve.knots == u)))
    count = len(curve.weights) - 1
    insertion = scipy.interpolate.BSpline(knots, np.eye(count), curve.degree).insert_knot(u).c[: count + 1]
    full = np.column_stack([curve.control_points * curve.weights[:, None], curve.weights])
    fewer = np.empty((count, full.shape[1]))
    fewer[[0, -1]] = full[[0, -1]]
    rest = full - insertion[:, [0, -1]] @ fewer[[0, -1]]
    fewer[1:-1] = np.linalg.lstsq(insertion[:, 1:-1], rest, rcond=None)[0]
    weights = fewer[:, -1]
    return Curve(curve.degree, knots, fewer[:, :-1] / weights[:, None], weights)


def to_json(curve: Curve) -> str:
    """Write the curve in geomdl's JSON exchange format."""
    spline = {
        "type": "spline",
        "rational": True,
        "dimension": curve.control_points.shape[1],
        "degree": curve.degree,
        "knotvector": curve.knots.tolist(),
        "control_points": {"points": curve.control_points.tolist(), "weights": curve.weights.tolist()},
        "delta": 0.01,
    }
    return json.dumps({"shape": {"type": "curve", "count": 1, "data": [spline]}}, indent=2)


def from_json(text: str) -> Curve:
    """Read the first curve of a text in geomdl's JSON exchange format; knots are scaled to [0, 1].

    Raises:
        UnusableInput: the text is no such file or holds no usable curve.
    """
    try:
        shape: dict[str, Any] = json.loads(text)["shape"]
        if shape["type"] != "curve":
            raise UnusableInput(f"the file holds a {shape['type']}, not a curve")
        spline = shape["data"][0]
        points = np.array(spline["control_points"]["points"], dtype=np.float64)
        weights = np.array(spline["control_points"].get("weights", np.ones(len(points))), dtype=np.float64)
        knots = _unit(np.array(spline["knotvector"], dtype=np.float64))
        degree = int(spline["degree"])
    except (ValueError, KeyError, IndexError, TypeError, AttributeError) as error:
        raise UnusableInput(f"this is no curve in geomdl's JSON format: {error!r}") from error
    return Curve(degree, knots, points, weights)


def _unit(knots: Array) -> Array:
    return np.asarray((knots - knots[0]) / (knots[-1] - knots[0]))
