"""Quick looks at a curve that is being edited: could the arm follow it, and if not, what should be moved?"""

from __future__ import annotations

from fastapi import APIRouter, Response
from pydantic import Field

from teachpath.api.access import TEACH
from teachpath.api.answers import json_response, model_of
from teachpath.api.curves import CurveBody
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body
from teachpath.api.versions import wanted_version
from teachpath.records import Assessment


class CurveToAssess(Body):
    """A curve that is being edited."""

    curve: CurveBody | None = Field(None, description="left out: that of the version")
    version: int | None = Field(None, ge=1, description="that was edited; without it the newest on the main branch")


def assessments_router(parts: Parts) -> APIRouter:
    """Return the route of assessments."""
    router = APIRouter(tags=["curves"])
    store = parts.store

    @router.post(
        "/paths/{path}/assessment", response_model=model_of(Assessment), responses=refusals(409), dependencies=TEACH
    )
    def assess_path(path: str, wanted: CurveToAssess) -> Response:
        """Look quickly at a curve: reach, joint limits and clearance along it, what fails first and what to move.

        Nothing is stored and nothing certified: that is for a plan. When a newer curve of the same path comes while
        one still waits, the older one is refused with 409.
        """
        stored = wanted_version(store, path, wanted.version)
        scene = parts.objects.scene_for(store.task(store.run(stored.run).task).scene, stored)
        curve = wanted.curve.curve() if wanted.curve else stored.curve
        settings = parts.settings
        return json_response(parts.assessor.assess(stored, scene, settings.motion, settings.arm, curve=curve))

    return router
