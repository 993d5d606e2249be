"""Motions as files of other programs: tables, ROS 2 messages and bags."""

from __future__ import annotations

from typing import Annotated, Final

from fastapi import APIRouter, Query, Response

from teachpath.api.access import VIEW
from teachpath.api.answers import files
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.io.programs.formats import FORMATS
from teachpath.robot.programs import ProgramFile

Format = Annotated[str, Query(description="; ".join(f"{name}: {kind.title}" for name, kind in FORMATS.items()))]
Rate = Annotated[float | None, Query(description="instants a second [Hz]; left out: as the format usually has")]
FILE: Final = files(*sorted({kind.media_type.partition(";")[0] for kind in FORMATS.values()}))


def programs_router(parts: Parts) -> APIRouter:
    """Return the routes of motions as files."""
    router = APIRouter(tags=["programs"])

    @router.get("/plans/{plan}/program", response_class=Response, responses=FILE, dependencies=VIEW)
    def get_plan_program(plan: str, format: Format = "csv", rate: Rate = None) -> Response:
        """Return the motion of a plan along its path as a file; only a plan whose certificate holds leaves.

        The head of the file says what was proved, and what is not covered on another controller.
        """
        return _download(parts.programs.of_plan(plan, format, rate))

    @router.get(
        "/executions/{execution}/program", response_class=Response, responses=FILE | refusals(409), dependencies=VIEW
    )
    def get_execution_program(execution: str, format: Format = "csv", rate: Rate = None) -> Response:
        """Return what the arm was sent in an execution that has ended, as a file."""
        return _download(parts.programs.of_execution(execution, format, rate))

    return router


def _download(file: ProgramFile) -> Response:
    disposition = f'attachment; filename="{file.name}"'
    return Response(file.content, media_type=file.media_type, headers={"Content-Disposition": disposition})
