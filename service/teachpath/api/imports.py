"""Imports: an uploaded file is written to a folder as it comes, and a job makes demonstrations of it."""

from __future__ import annotations

from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Final

from fastapi import APIRouter, Query, Request, Response
from pydantic import WithJsonSchema
from starlette.concurrency import run_in_threadpool

from teachpath.api.access import DEMONSTRATE, Sender
from teachpath.api.answers import located
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.work import IdempotencyKey, accepted, submitter_of
from teachpath.errors import UnusableInput
from teachpath.io.readers.contract import QUATERNION_ORDERS, TIME_UNITS, UNITS
from teachpath.io.readers.registry import check_options
from teachpath.io.store.faults import storage_fault
from teachpath.jobs.idempotency import begun_by
from teachpath.offline.import_job import UPLOAD, ImportRequest, UploadedFile
from teachpath.offline.import_target import import_calibration, import_scene
from teachpath.offline.track_samples import PhaseMarks
from teachpath.records import Job
from teachpath_proto.keys import is_name, name_refusal

FILE_BODY: Final[dict[str, Any]] = {
    "required": True,
    "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
}

# One of these words or none; the reader's own check says in a sentence what others may mean.
LengthUnit = Annotated[str, WithJsonSchema({"type": "string", "enum": ["", *UNITS]})]
TimeUnit = Annotated[str, WithJsonSchema({"type": "string", "enum": ["", *TIME_UNITS]})]
QuaternionOrder = Annotated[str, WithJsonSchema({"type": "string", "enum": ["", *QUATERNION_ORDERS]})]


def imports_router(parts: Parts) -> APIRouter:
    """Return the route of imports."""
    router = APIRouter(tags=["tasks"])

    @router.post(
        "/tasks/{task}/demonstrations",
        status_code=202,
        openapi_extra={"requestBody": FILE_BODY},
        responses=refusals(409, 507) | located(202, "the job"),
        dependencies=DEMONSTRATE,
    )
    async def import_demonstrations(
        task: str,
        sender: Sender,
        request: Request,
        response: Response,
        name: Annotated[str, Query(description="name of the source", max_length=200)] = "upload",
        format: Annotated[str, Query(description="name of a reader, or mcap; empty: what the file has")] = "",
        units: Annotated[LengthUnit, Query(description="of the positions; empty: as the file says")] = "",
        time: Annotated[TimeUnit, Query(description="unit of the clock; empty: as the file says")] = "",
        rate: Annotated[float, Query(description="[Hz] for a format without a clock; 0: 50")] = 0.0,
        columns: Annotated[str, Query(description="where a table has what: t=Time,x=2,...", max_length=1000)] = "",
        quaternion: Annotated[QuaternionOrder, Query(description="order of columns without names")] = "",
        track: Annotated[str, Query(description="which one, of a file with several", max_length=200)] = "",
        grasp: Annotated[float | None, Query(description="[s] at which the object is taken")] = None,
        release: Annotated[float | None, Query(description="[s] at which it is put")] = None,
        whole: Annotated[bool, Query(description="the whole motion is the transport")] = False,
        scene: Annotated[str, Query(description="of a new task; empty: that of the task, or empty")] = "",
        calibration: Annotated[str, Query(description="of the file's frame; empty: that of the task")] = "",
        object_at_grasp: Annotated[
            bool, Query(description="of a new task: each motion begins at its object, wherever that is")
        ] = False,
        key: IdempotencyKey = "",
    ) -> Job:
        """Queue the import of a file sent as the request's body; `Location` names the job.

        Every motion in the file becomes a demonstration, all of them or none. The job's outcome are the numbers of the
        first and the last one, e.g. `3-5`.
        """
        if not is_name(task):
            raise UnusableInput(name_refusal("task", task))
        marks = PhaseMarks(grasp, release, whole)
        file = UploadedFile("", name, format, units, rate, time, columns, quaternion, track, marks)
        check_options(name, format, file.options)
        store, calibrations = parts.store, parts.calibrations
        await run_in_threadpool(lambda: parts.scenes.get(import_scene(store, task, scene)))
        await run_in_threadpool(import_calibration, store, calibrations, task, format, calibration)
        submitter = submitter_of(request, sender)
        order = ImportRequest((file,), scene, calibration, object_at_grasp)
        if known := await run_in_threadpool(begun_by, store, task, "import", asdict(order), submitter, key):
            return accepted(known, response)
        parts.jobs.require_room(submitter)
        return accepted(await _submit(parts, request, task, order, sender.name, submitter, key), response)

    return router


async def _submit(
    parts: Parts, request: Request, task: str, order: ImportRequest, who: str, submitter: str, key: str
) -> Job:
    """Keep the request's body as the file of the order, and queue its import; no file stays behind a refusal."""
    folder = await run_in_threadpool(parts.transfers.make)
    (file,) = order.files
    order = replace(order, files=(replace(file, upload=folder.name),))
    try:
        await receive_file(request, folder / UPLOAD, file.name)
        submit = partial(parts.jobs.submit, task, "import", asdict(order), submitter, who=who, idempotency_key=key)
        return await run_in_threadpool(submit)
    except BaseException:
        parts.transfers.remove(folder.name)
        raise


async def receive_file(request: Request, file: Path, name: str) -> None:
    """Write the body of a request to a file as it comes, so that it never is in memory as a whole."""
    try:
        with file.open("wb") as stream:
            async for piece in request.stream():
                await run_in_threadpool(stream.write, piece)
            is_empty = stream.tell() == 0
    except OSError as error:
        raise storage_fault(error, name) or error from None
    if is_empty:
        raise UnusableInput(f"{name}: the file is empty")
