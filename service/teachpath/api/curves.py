"""Operations on a curve as pure calls: nothing is stored."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Response
from pydantic import Field, Strict

from teachpath.api.access import TEACH
from teachpath.api.answers import json_response, model_of
from teachpath.api.parts import Parts
from teachpath.api.strict_requests import Body
from teachpath.editing import MAX_CONTROL_POINTS, EditResult, check_editable, elevate_degree, insert_knot, remove_knot
from teachpath.errors import UnusableInput
from teachpath.exchange import SAME_SHAPE_TOLERANCE
from teachpath.nurbs import Curve

MAX_PARAMETERS = 2001
Point = Annotated[tuple[float, float, float], Strict(False)]


class CurveBody(Body):
    """A clamped NURBS on [0, 1]."""

    degree: int = Field(ge=1, le=7, description="of the polynomials")
    knots: list[float] = Field(
        max_length=MAX_CONTROL_POINTS + 8, description="non-decreasing, degree + 1 times 0 and 1"
    )
    control_points: list[Point] = Field(max_length=MAX_CONTROL_POINTS, description="x, y, z in the world [m]")
    weights: list[float] = Field(max_length=MAX_CONTROL_POINTS, description="positive")

    def curve(self) -> Curve:
        """Return the curve; raises UnusableInput when it is none that can be edited."""
        points: Any = self.control_points  # numpy makes an array of them, and of none at all
        return check_editable(Curve(self.degree, self.knots, points, self.weights))  # type: ignore[arg-type]


class CurveEvaluation(Body):
    """Where to evaluate a curve."""

    curve: CurveBody = Field(description="to evaluate")
    u: list[Annotated[float, Field(ge=0.0, le=1.0)]] = Field(max_length=MAX_PARAMETERS, description="parameters")


class CurveOperation(Body):
    """A curve to operate on."""

    curve: CurveBody = Field(description="to operate on")
    u: float | None = Field(None, description="insert-knot, remove-knot: the parameter of the knot, in (0, 1)")
    tolerance: float = Field(SAME_SHAPE_TOLERANCE, description="remove-knot: distance by which the curve may move [m]")


def curves_router(parts: Parts) -> APIRouter:
    """Return the routes of operations on curves."""
    router = APIRouter(tags=["curves"])

    @router.post("/curves/evaluate", dependencies=TEACH)
    def evaluate_curve(evaluation: CurveEvaluation) -> list[list[float]]:
        """Return the points of a curve [m] at parameters u."""
        points: list[list[float]] = evaluation.curve.curve()(evaluation.u).tolist() if evaluation.u else []  # type: ignore[arg-type]
        return points

    @router.post("/curves/{operation}", response_model=model_of(EditResult), dependencies=TEACH)
    def operate_on_curve(
        operation: Literal["insert-knot", "remove-knot", "elevate"], wanted: CurveOperation
    ) -> Response:
        """Insert or remove a knot, or raise the degree, and leave the shape; `deviation` is how far it moved [m]."""
        return json_response(_operated(operation, wanted))

    return router


def _operated(operation: str, wanted: CurveOperation) -> EditResult:
    curve = wanted.curve.curve()
    if operation == "elevate":
        return elevate_degree(curve)
    if wanted.u is None:
        raise UnusableInput(f"{operation} needs the parameter u of the knot, between 0 and 1")
    if operation == "insert-knot":
        return insert_knot(curve, wanted.u)
    return remove_knot(curve, wanted.u, tolerance=wanted.tolerance)
