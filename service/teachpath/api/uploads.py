"""Uploads: files are sent, looked at, corrected, and then imported, all of them or none."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Annotated, Final

from fastapi import APIRouter, Query, Request, Response
from fastapi import Path as PathParameter
from pydantic import Field
from starlette.concurrency import run_in_threadpool

from teachpath.api.access import DEMONSTRATE, VIEW, Sender
from teachpath.api.answers import json_response, located, model_of
from teachpath.api.imports import FILE_BODY, LengthUnit, QuaternionOrder, TimeUnit, receive_file
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body, named_in_body
from teachpath.api.work import IdempotencyKey, accepted, submitter_of
from teachpath.errors import Conflict, NotFound, QueueFull, UnusableInput
from teachpath.io.readers.registry import check_options, readers
from teachpath.jobs.idempotency import begun_by
from teachpath.offline.file_report import FileReport, examine_upload
from teachpath.offline.import_job import UPLOAD, ImportOrder, ImportRequest, UploadedFile
from teachpath.offline.import_target import import_calibration, import_scene, starts_at_object
from teachpath.offline.track_samples import MotionMarks, PhaseMarks
from teachpath.records import Job
from teachpath_proto.keys import is_name, name_refusal

UPLOAD_LIFETIME: Final = 86_400.0  # [s] for which a file waits to be imported
MAX_UPLOADS: Final = 2000  # files that wait
MAX_FILES: Final = 1000  # of one import
ID_PATTERN: Final = "^[0-9a-f]{32}$"

UploadId = Annotated[str, PathParameter(pattern=ID_PATTERN, description="id of the upload")]


class Upload(Body):
    """A file that was sent and waits to be imported, for a day or until the service ends."""

    id: str = Field(description="by which it is examined and imported")
    name: str = Field(description="of the file")
    size: int = Field(description="bytes")


class ReaderName(Body):
    """A reader of recordings."""

    name: str = Field(description="as `format` takes it")
    title: str = Field(description="what it reads")


class MarkedMotion(Body):
    """Where one motion of a file takes and puts the object."""

    motion: int = Field(ge=1, description="its number in the file, from 1")
    grasp: float | None = Field(None, allow_inf_nan=False, description="[s] from its beginning, at which it is taken")
    release: float | None = Field(None, allow_inf_nan=False, description="[s] at which it is put")
    whole: bool = Field(False, description="all of it is the transport")


class FileChoices(Body):
    """How a file is read: what is empty, the file or its format has to say."""

    name: str = Field("upload", max_length=200, description="of the file")
    format: str = Field("", description="name of a reader, or mcap; empty: what the file has")
    units: LengthUnit = Field("", description="of the positions")
    time: TimeUnit = Field("", description="unit of the clock")
    rate: float = Field(0.0, allow_inf_nan=False, description="[Hz] for a format without a clock; 0: 50")
    columns: str = Field("", max_length=1000, description="where a table has what: t=Time,x=2,...")
    quaternion: QuaternionOrder = Field("", description="order of columns without names")
    track: str = Field("", max_length=200, description="which one, of a file with several")
    grasp: float | None = Field(
        None, allow_inf_nan=False, description="[s] from the beginning, at which the object is taken"
    )
    release: float | None = Field(None, allow_inf_nan=False, description="[s] at which it is put")
    whole: bool = Field(False, description="the whole motion is the transport")
    motion_marks: list[MarkedMotion] = Field(
        default_factory=list, max_length=1000, description="of single motions, before those of the file"
    )

    def of_upload(self, upload: str) -> UploadedFile:
        """Return the file of an upload, read so; raises UnusableRecording."""
        file = UploadedFile(
            upload,
            self.name,
            self.format,
            self.units,
            self.rate,
            self.time,
            self.columns,
            self.quaternion,
            self.track,
            PhaseMarks(self.grasp, self.release, self.whole),
            tuple(MotionMarks(each.grasp, each.release, each.whole, each.motion) for each in self.motion_marks),
        )
        check_options(self.name, self.format, file.options)
        return file


class ImportPlace(Body):
    """What the files of an import have in common."""

    scene: str = Field("", description="of a new task; empty: that of the task, or empty")
    calibration: str = Field("", description="of the files' frame; empty: that of the task, or identity")
    object_at_grasp: bool = Field(
        False, description="of a new task: each motion begins at its object, wherever that is"
    )


class Examination(ImportPlace):
    """How a file is to be read and judged."""

    file: FileChoices = Field(description="how it is read")
    task: str = Field(description="that it is to be imported into")
    motion: int = Field(1, ge=1, description="number of the motion to show, from 1")


class UploadChoices(FileChoices):
    """An upload, and how it is read."""

    upload: str = Field(pattern=ID_PATTERN, description="id of the upload")


class NewImport(ImportPlace):
    """Uploads to import, all of them or none."""

    files: list[UploadChoices] = Field(min_length=1, max_length=MAX_FILES, description="in their order")


def uploads_router(parts: Parts) -> APIRouter:
    """Return the routes of uploads."""
    router = APIRouter(tags=["tasks"])
    _add_uploads(router, parts)
    _add_examination(router, parts)
    _add_import(router, parts)
    return router


def _add_uploads(router: APIRouter, parts: Parts) -> None:
    transfers, store = parts.transfers, parts.store

    @router.get("/readers", dependencies=VIEW)
    def list_readers() -> list[ReaderName]:
        """List what reads recordings of other programs, those of other packages too."""
        return [ReaderName(name=reader.name, title=reader.title) for reader in readers().values()]

    @router.post(
        "/uploads",
        status_code=201,
        openapi_extra={"requestBody": FILE_BODY},
        responses=refusals(507),
        dependencies=DEMONSTRATE,
    )
    async def upload_file(
        request: Request,
        sender: Sender,
        name: Annotated[str, Query(description="of the file", max_length=200)] = "upload",
    ) -> Upload:
        """Keep a file sent as the request's body, to be examined and imported."""
        submitter = submitter_of(request, sender)
        await run_in_threadpool(_make_room, parts, submitter)
        folder = await run_in_threadpool(transfers.make, submitter)
        try:
            await receive_file(request, folder / UPLOAD, name)
        except BaseException:
            transfers.remove(folder.name)
            raise
        return Upload(id=folder.name, name=name, size=(folder / UPLOAD).stat().st_size)

    @router.delete("/uploads/{upload}", status_code=204, responses=refusals(409), dependencies=DEMONSTRATE)
    def remove_upload(upload: UploadId) -> None:
        """Remove an upload that no import waits for."""
        _require(parts, upload)
        if upload in store.awaited_uploads():
            raise Conflict(f"upload {upload} is being imported; cancel that job first")
        transfers.remove(upload)


def _add_examination(router: APIRouter, parts: Parts) -> None:
    store = parts.store

    @router.post(
        "/uploads/{upload}/examination",
        response_model=model_of(FileReport),
        responses=refusals(409),
        dependencies=DEMONSTRATE,
    )
    def examine_file(upload: UploadId, examination: Examination) -> Response:
        """Say what is understood of an upload, and what would be made of it; nothing is stored."""
        _require(parts, upload)
        file, task = examination.file.of_upload(upload), _checked_task(examination.task)
        order = ImportOrder(
            key="examination",
            folder=parts.transfers.folder(upload),
            task=task,
            name=file.name,
            kind=file.format,
            options=file.options,
            marks=file.marks,
            scene=parts.scenes.get(import_scene(store, task, examination.scene)),
            calibration=import_calibration(store, parts.calibrations, task, file.format, examination.calibration),
            recording=parts.settings.recording,
            limits=parts.settings.imports,
            object_at_grasp=starts_at_object(store, task, examination.object_at_grasp),
            motion_marks=file.motion_marks,
            arm=parts.settings.arm,
        )
        report = parts.reader.call(examine_upload, order, examination.motion)
        return json_response(replace(report, imported_before=store.imported_files.imported_before(task, report.sha256)))


def _add_import(router: APIRouter, parts: Parts) -> None:
    store = parts.store

    @router.post(
        "/tasks/{task}/imports",
        status_code=202,
        responses=refusals(409, 507) | located(202, "the job"),
        dependencies=DEMONSTRATE,
    )
    def import_uploads(
        task: str, new: NewImport, sender: Sender, request: Request, response: Response, key: IdempotencyKey = ""
    ) -> Job:
        """Queue the import of uploads; `Location` names the job.

        Every motion in them becomes a demonstration, all of them or none. The job's outcome are the numbers of the
        first and the last one, e.g. `3-5`; the source of each is the name of its file.
        """
        _checked_task(task)
        files = tuple(each.of_upload(each.upload) for each in new.files)
        order = asdict(ImportRequest(files, new.scene, new.calibration, new.object_at_grasp))
        submitter = submitter_of(request, sender)
        if known := begun_by(store, task, "import", order, submitter, key):
            return accepted(known, response)
        for file in files:
            with named_in_body("files"):
                _require(parts, file.upload)
        with named_in_body("scene"):
            parts.scenes.get(import_scene(store, task, new.scene))
        with named_in_body("calibration"):
            import_calibration(store, parts.calibrations, task, "", new.calibration)
        job = parts.jobs.submit(task, "import", order, submitter, who=sender.name, idempotency_key=key)
        return accepted(job, response)


def _checked_task(task: str) -> str:
    if not is_name(task):
        raise UnusableInput(name_refusal("task", task))
    return task


def _require(parts: Parts, upload: str) -> None:
    if not (parts.transfers.folder(upload) / UPLOAD).is_file():
        raise NotFound(f"there is no upload {upload!r} any more; send the file again")


def _make_room(parts: Parts, submitter: str) -> None:
    parts.transfers.remove_forgotten(parts.store.awaited_uploads(), UPLOAD_LIFETIME)
    if (count := len(parts.transfers.names())) >= MAX_UPLOADS:
        raise QueueFull(f"{count} files wait to be imported, limit {MAX_UPLOADS}; import them, or remove some")
    if (size := parts.transfers.size_of(submitter)) >= (limit := parts.settings.limits.waiting_size):
        raise QueueFull(
            f"{size / 1e6:.0f} MB of files of {submitter} wait to be imported, limit {limit / 1e6:.0f} MB "
            "(limits.waiting_size); import them, or remove some"
        )
