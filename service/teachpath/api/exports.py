"""Demonstrations as files to download: one of them, or all of a task as a zip."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Final, Literal

from fastapi import APIRouter, Query, Request
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool

from teachpath.api.access import VIEW, Sender
from teachpath.api.answers import MCAP, files
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.work import submitter_of
from teachpath.offline.exporting import chosen
from teachpath.records import Demonstration

OneFormat = Literal["csv", "mcap", "trajectory"]
Format = Literal["csv", "mcap", "trajectory", "lerobot", "lerobot-2.1", "archive"]
CSV: Final = "text/csv"
ZIP: Final = "application/zip"
MEDIA_TYPES: Final = {".csv": CSV, ".zip": ZIP}
FORMAT = (
    "csv or mcap: every sample, to be imported again; trajectory: the object's, as csv; lerobot: a dataset of version "
    "3.0; lerobot-2.1: of version 2.1; archive: the task, with a SHA-256 of each file"
)


def exports_router(parts: Parts) -> APIRouter:
    """Return the routes of exports; a process of their own writes the files."""
    router = APIRouter(tags=["exports"])

    @router.get(
        "/demonstrations/{demonstration}/export",
        response_class=FileResponse,
        responses=files(MCAP, CSV) | refusals(507),
        dependencies=VIEW,
    )
    async def export_demonstration(
        demonstration: str,
        sender: Sender,
        request: Request,
        format: Annotated[OneFormat, Query(description=FORMAT)] = "mcap",
    ) -> FileResponse:
        """Return one demonstration as a file."""
        row = await run_in_threadpool(parts.store.demonstration, demonstration)
        return await _export(parts, [row], format, "", submitter_of(request, sender))

    @router.get(
        "/tasks/{task}/export",
        response_class=FileResponse,
        responses=files(ZIP) | refusals(507),
        dependencies=VIEW,
    )
    async def export_task(
        task: str,
        sender: Sender,
        request: Request,
        format: Annotated[Format, Query(description=FORMAT)] = "mcap",
        all: Annotated[bool, Query(description="also rejected, discarded and bad ones")] = False,
    ) -> FileResponse:
        """Return the demonstrations of a task as a zip file."""
        rows = await run_in_threadpool(partial(chosen, parts.store, task, all_=all))
        return await _export(parts, rows, format, f"{task}-{format}.zip", submitter_of(request, sender))

    return router


async def _export(parts: Parts, rows: list[Demonstration], kind: str, zip_name: str, submitter: str) -> FileResponse:
    """Return the file of the only row, or a zip file of that name."""
    folder = await run_in_threadpool(parts.transfers.make)
    remove = partial(parts.transfers.remove, folder.name)
    try:
        file = await parts.exporter.write(rows, kind, folder, zipped=bool(zip_name), submitter=submitter)
    except BaseException:
        remove()
        raise
    return FileResponse(
        file,
        media_type=MEDIA_TYPES.get(file.suffix, MCAP),
        filename=zip_name or file.name,
        background=BackgroundTask(remove),
    )
