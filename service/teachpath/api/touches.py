"""Places that are touched with a tracker, to calibrate it or to place what stands in a scene."""

from __future__ import annotations

from fastapi import APIRouter
from pydantic import Field

from teachpath.api.access import TEACH
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body
from teachpath.recorder.touches import Touch


class NewTouch(Body):
    """How a place is touched."""

    hold_time: float = Field(1.0, ge=0.1, le=5.0, description="[s] that the tracker is held still, by its own clock")


def touches_router(parts: Parts) -> APIRouter:
    """Return the route by which a place is touched."""
    router = APIRouter(tags=["calibrations"])
    touches = parts.recorder.touches

    @router.post("/trackers/{tracker}/touches", responses=refusals(409, 503), dependencies=TEACH)
    def touch_place(tracker: str, touch: NewTouch) -> Touch:
        """Measure where a tracker sees itself while it is held still from now on; nothing is kept.

        The place is in the tracker's own frame: pairs of such places and of where they are make a calibration.
        """
        return touches.measure(tracker, hold_time=touch.hold_time)

    return router
