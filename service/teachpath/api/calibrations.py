"""Calibrations: the trackers' frames in the world, measured from taught points; every version is kept."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter
from pydantic import Field, Strict

from teachpath.api.access import TEACH, VIEW, Sender, signed
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body, named_in_body
from teachpath.api.versions import LINE_PATTERN
from teachpath.errors import NotFound
from teachpath.records import Demonstration, MeasuredCalibration, TaughtPoint

MAX_POINTS = 1000
Coordinate = Annotated[float, Field(allow_inf_nan=False)]
Place = Annotated[tuple[Coordinate, Coordinate, Coordinate], Strict(False)]


class PointPair(Body):
    """One place that was shown to the tracker."""

    tracker: Place = Field(description="where the tracker saw it [m]")
    world: Place = Field(description="where it is [m, world]")


class NewCalibration(Body):
    """What a calibration is measured with."""

    points: list[PointPair] = Field(max_length=MAX_POINTS, description="three or more, not on one line")
    source: str = Field("", max_length=200, description="tracker that was shown the points")
    fit_scale: bool = Field(False, description="find the scale too; else it is 1, as for trackers in metres")
    author: str = Field("", max_length=80, pattern=LINE_PATTERN, description="who measures it")
    keep: bool = Field(True, description="false: only say what the calibration and its residuals would be")


class CalibrationChoice(Body):
    """Under which calibration demonstrations are put."""

    calibration: str = Field(
        "", description="e.g. lab, or lab@2 for its second version; empty: each one's own, today's"
    )


def calibrations_router(parts: Parts) -> APIRouter:
    """Return the routes of calibrations."""
    router = APIRouter(tags=["calibrations"])
    calibrations, store = parts.calibrations, parts.store

    @router.get("/calibrations", dependencies=VIEW)
    def list_calibrations() -> list[MeasuredCalibration]:
        """List the mappings to the world from the trackers' frames: of the settings, and the newest measured ones."""
        return calibrations.newest()

    @router.get("/calibrations/{name}", dependencies=VIEW)
    def list_calibration_versions(name: str) -> list[MeasuredCalibration]:
        """List the versions of a calibration, newest first, with the points and residuals of each."""
        found = store.calibrations.versions(name)
        return found or [MeasuredCalibration(calibrations.get(name))]

    @router.put("/calibrations/{name}", responses=refusals(409, 507), dependencies=TEACH)
    def measure_calibration(name: str, new: NewCalibration, sender: Sender) -> MeasuredCalibration:
        """Fit a calibration to taught points and keep it as the next version of its name.

        Demonstrations recorded before keep the version that they were recorded under.
        """
        return calibrations.measure(
            name,
            [TaughtPoint(point.tracker, point.world) for point in new.points],
            source=new.source,
            fit_scale=new.fit_scale,
            keep=new.keep,
            author=signed(sender, new.author),
        )

    @router.post("/tasks/{task}/calibration", responses=refusals(409, 507), dependencies=TEACH)
    def convert_demonstrations(task: str, choice: CalibrationChoice) -> list[Demonstration]:
        """Put all demonstrations of a task under a calibration as it is today and judge them again; can be undone."""
        stored = store.demonstrations(store.task(task).name)
        if not stored:
            raise NotFound(f"task {task} has no demonstrations yet")
        with named_in_body("calibration"):
            changed = calibrations.convert(stored, choice.calibration)
        parts.recorder.annotations.on_change(changed[-1])
        return changed

    return router
