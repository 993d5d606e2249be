"""A curve as a DXF file with one SPLINE entity, exact: degree, knots, control points and weights.

Autodesk: DXF Reference, group codes of SPLINE and of the sections; version AC1015 (AutoCAD 2000).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from teachpath.nurbs import Curve

RATIONAL: Final = 4  # flag of the entity
METRES: Final = 6  # of the drawing, $INSUNITS


def curve_dxf(curve: Curve) -> str:
    """Write a curve of positions [m] as a drawing in metres."""
    groups = [
        (0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1015"), (9, "$INSUNITS"), (70, METRES), (0, "ENDSEC"),
        (0, "SECTION"), (2, "ENTITIES"), *_spline(curve), (0, "ENDSEC"), (0, "EOF"),
    ]  # fmt: skip
    return "".join(f"{code:3d}\n{value}\n" for code, value in groups)


def _spline(curve: Curve) -> Iterator[tuple[int, object]]:
    yield from [(0, "SPLINE"), (5, "2A"), (100, "AcDbEntity"), (8, "0"), (100, "AcDbSpline")]
    yield from [(70, RATIONAL), (71, curve.degree), (72, len(curve.knots)), (73, len(curve.control_points)), (74, 0)]
    yield from ((40, repr(knot)) for knot in curve.knots.tolist())
    yield from ((41, repr(weight)) for weight in curve.weights.tolist())
    for point in curve.control_points.tolist():
        yield from ((code, repr(value)) for code, value in zip((10, 20, 30), point, strict=True))
