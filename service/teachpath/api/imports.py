"""Imports: an uploaded file is written to a folder as it comes, and a job makes demonstrations of it."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Final

from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from teachpath.api.parts import Parts
from teachpath.api.work import accepted, submitter_of
from teachpath.errors import UnusableInput
from teachpath.io.files import check_format
from teachpath.io.store.faults import storage_fault
from teachpath.offline.import_job import UPLOAD, ImportRequest
from teachpath.records import Job
from teachpath_proto.keys import is_name, name_refusal

FILE_BODY: Final = {
    "required": True,
    "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
}


def imports_router(parts: Parts) -> APIRouter:
    """Return the route of imports."""
    router = APIRouter(tags=["tasks"])

    @router.post("/tasks/{task}/demonstrations", status_code=202, openapi_extra={"requestBody": FILE_BODY})
    async def import_demonstrations(
        task: str,
        request: Request,
        response: Response,
        name: Annotated[str, Query(description="name of the source", max_length=200)] = "upload",
        format: Annotated[str, Query(description="csv, npy, robottasks or mcap")] = "csv",
        units: Annotated[str, Query(description="of the positions: m, cm, mm or in")] = "m",
        rate: Annotated[float, Query(description="[Hz] for a format without a clock")] = 50.0,
        scene: Annotated[str, Query(description="of a new task")] = "empty",
        calibration: Annotated[str, Query(description="of the file's frame; mcap brings its own")] = "identity",
        object_at_grasp: Annotated[
            bool, Query(description="of a new task: each motion begins at its object, wherever that is")
        ] = False,
    ) -> Job:
        """Queue the import of a file sent as the request's body; `Location` names the job.

        Every motion in the file becomes a demonstration, all of them or none. The job's outcome are the numbers of the
        first and the last one, e.g. `3-5`.
        """
        if not is_name(task):
            raise UnusableInput(name_refusal("task", task))
        check_format(name, format, units, rate)
        parts.settings.scene(scene)
        await run_in_threadpool(parts.calibrations.get, calibration)
        submitter = submitter_of(request)
        parts.jobs.require_room(submitter)
        folder = await run_in_threadpool(parts.transfers.make)
        order = ImportRequest(folder.name, name, format, units, rate, scene, calibration, object_at_grasp)
        try:
            await _receive(request, folder / UPLOAD, name)
            job = await run_in_threadpool(parts.jobs.submit, task, "import", asdict(order), submitter)
        except BaseException:
            parts.transfers.remove(folder.name)
            raise
        return accepted(job, response)

    return router


async def _receive(request: Request, file: Path, name: str) -> None:
    """Write the body of a request to a file as it comes, so that it never is in memory as a whole."""
    try:
        with file.open("wb") as stream:
            async for piece in request.stream():
                await run_in_threadpool(stream.write, piece)
    except OSError as error:
        raise storage_fault(error, name) or error from None
