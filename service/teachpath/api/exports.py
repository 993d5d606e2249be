"""Demonstrations as files to download: one of them, or all of a task as a zip."""

from __future__ import annotations

import shutil
import tempfile
import zipfile
from pathlib import Path
from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask

from teachpath.api.parts import Parts
from teachpath.offline.exporting import SUFFIXES, chosen, content_of, export_demonstrations

OneFormat = Literal["csv", "mcap", "trajectory"]
Format = Literal["csv", "mcap", "trajectory", "lerobot"]
FORMAT = "csv or mcap: every sample, to be imported again; trajectory: the object's, as csv; lerobot: a dataset"


def exports_router(parts: Parts) -> APIRouter:
    """Return the routes of exports."""
    router = APIRouter(tags=["exports"])
    store = parts.store

    @router.get("/demonstrations/{demonstration}/export", response_class=Response)
    def export_demonstration(
        demonstration: str, format: Annotated[OneFormat, Query(description=FORMAT)] = "mcap"
    ) -> Response:
        """Return one demonstration as a file."""
        row = store.demonstration(demonstration)
        name = f"{row.task}-{row.number:03d}{SUFFIXES[format]}"
        headers = {"Content-Disposition": f'attachment; filename="{name}"'}
        content = content_of(store, row, format, parts.trajectory)
        return Response(content, media_type="application/octet-stream", headers=headers)

    @router.get("/tasks/{task}/export", response_class=FileResponse)
    def export_task(
        task: str,
        format: Annotated[Format, Query(description=FORMAT)] = "mcap",
        all: Annotated[bool, Query(description="also rejected, discarded and bad ones")] = False,
    ) -> FileResponse:
        """Return the demonstrations of a task as a zip file."""
        rows = chosen(store, task, all_=all)
        folder = Path(tempfile.mkdtemp(prefix="teachpath-export-"))
        try:
            written = export_demonstrations(store, rows, format, folder / "files", trajectory=parts.trajectory)
            with zipfile.ZipFile(folder / "export.zip", "w", zipfile.ZIP_DEFLATED) as archive:
                for file in written:
                    for each in sorted(file.rglob("*")) if file.is_dir() else [file]:
                        archive.write(each, each.relative_to(folder / "files"))
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        away = BackgroundTask(shutil.rmtree, folder, ignore_errors=True)
        return FileResponse(folder / "export.zip", filename=f"{task}-{format}.zip", background=away)

    return router
