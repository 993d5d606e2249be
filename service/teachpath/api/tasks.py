"""Tasks and their demonstrations: make, record, import, read."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request
from fastapi.responses import FileResponse
from pydantic import BaseModel, Field
from starlette.concurrency import run_in_threadpool

from teachpath.api.parts import Parts
from teachpath.errors import UnusableInput
from teachpath.io.documents import to_document
from teachpath.io.wire import report_document
from teachpath.offline.importing import Source, import_file
from teachpath.recording.control import Routine
from teachpath.records import Demonstration, Task
from teachpath.workers.curation import Amendment
from teachpath_proto.keys import is_name


class NewTask(BaseModel):
    """A task to make."""

    scene: str = Field("paper", description="what stands around the arm; see /scenes")
    calibration: str = Field("identity", description="of the tracker's frame; see /calibrations")


class Recording(BaseModel):
    """A recording to start or stop."""

    tracker: str = Field(description="name of the tracker that shows the task")
    calibration: str = Field("", description="start: instead of the task's own")
    rate: float = Field(0.0, ge=0.0, le=10_000.0, description="start: samples a second that it sends; 0 = not said")
    armed: bool = Field(False, description="start: paused, until pedal, fist or `resume` begins the first take")
    countdown: float | None = Field(None, ge=0.0, le=60.0, description="start: [s] before each take; else the setting")
    takes: int = Field(0, ge=0, le=10_000, description="start: pause by itself after so many demonstrations; 0 = never")
    one_by_one: bool = Field(False, description="start: pause after each demonstration")
    discard: bool = Field(False, description="stop: throw away the demonstration that is still open")


class Named(BaseModel):
    """A tracker whose recording is meant."""

    tracker: str = Field(description="name of the tracker that is recording the task")


class Amended(BaseModel):
    """What an operator says of a demonstration; what is left out stays as it is."""

    mark: Literal["", "good", "bad"] | None = Field(None, description="good, bad, or empty for none")
    discarded: bool | None = Field(None, description="discarded ones are kept, but not learned from")
    trim: tuple[int, int] | None = Field(
        None, description="transport phase, samples[begin:end]; [0, 0] brings back the recorder's own cut"
    )


def tasks_router(parts: Parts) -> APIRouter:
    """Return the routes of tasks and demonstrations."""
    router = APIRouter(tags=["tasks"])
    store = parts.store

    @router.get("/tasks")
    def list_tasks() -> list[Task]:
        """List all tasks, oldest first."""
        return store.tasks()

    @router.put("/tasks/{task}")
    def make_task(task: str, new: NewTask) -> Task:
        """Make a task; one that exists stays as it is."""
        if not is_name(task):
            raise UnusableInput(f"{task!r} cannot name a task: use letters, digits, '.', '_' or '-', at most 64")
        scene, calibration = parts.settings.scene(new.scene), parts.calibrations.get(new.calibration)
        return store.ensure_task(task, scene=scene.name, calibration=calibration.name)

    @router.get("/tasks/{task}")
    def get_task(task: str) -> Task:
        """Return one task."""
        return store.task(task)

    @router.get("/tasks/{task}/demonstrations")
    def list_demonstrations(task: str) -> list[Demonstration]:
        """List a task's demonstrations in their order, each with its verdict and account."""
        return store.demonstrations(store.task(task).name)

    @router.post("/tasks/{task}/demonstrations", status_code=201)
    async def import_demonstrations(
        task: str,
        request: Request,
        name: Annotated[str, Query(description="name of the source", max_length=200)] = "upload",
        format: Annotated[str, Query(description="csv, robottasks or mcap")] = "csv",
        units: Annotated[str, Query(description="of the positions: m, cm, mm or in")] = "m",
        rate: Annotated[float, Query(description="[Hz] for a format without a clock")] = 50.0,
        scene: Annotated[str, Query(description="of a new task")] = "empty",
        calibration: Annotated[str, Query(description="of the file's frame; mcap brings its own")] = "identity",
    ) -> list[Demonstration]:
        """Import a file sent as the request's body; every motion in it becomes a demonstration."""
        content = await request.body()
        made = await run_in_threadpool(
            import_file,
            store,
            parts.settings.recording,
            Source(name, content, format, units, rate),
            task=task,
            scene=parts.settings.scene(scene),
            calibration=parts.calibrations.get(calibration),
        )
        for demonstration, trajectory in made:
            parts.imported(demonstration, trajectory)
        return [demonstration for demonstration, _ in made]

    @router.get("/demonstrations/{demonstration}")
    def get_demonstration(demonstration: str) -> Demonstration:
        """Return one demonstration."""
        return store.demonstration(demonstration)

    @router.patch("/demonstrations/{demonstration}")
    def amend_demonstration(demonstration: str, amended: Amended) -> Demonstration:
        """Mark, discard, restore or trim a demonstration; its recording and the recorder's own cut stay."""
        return parts.recorder.curation.amend(
            demonstration, Amendment(mark=amended.mark, discarded=amended.discarded, trim=amended.trim)
        )

    @router.get("/demonstrations/{demonstration}/trajectory")
    def get_trajectory(
        demonstration: str,
        most: Annotated[int, Query(ge=2, le=100_000, description="points; further ones are left out evenly")] = 100_000,
    ) -> dict[str, Any]:
        """Return the object's trajectory in its transport phase: times [s], positions [m], orientations, world."""
        return to_document(parts.trajectory(store.demonstration(demonstration)).thinned(most))

    @router.get("/demonstrations/{demonstration}/recording", response_class=FileResponse)
    def get_recording(demonstration: str) -> FileResponse:
        """Return the MCAP file with every sample."""
        file = store.recordings.path(store.demonstration(demonstration).recording)
        return FileResponse(file, media_type="application/octet-stream", filename=file.name)

    return router


def recording_router(parts: Parts) -> APIRouter:
    """Return the routes that start and stop recording; tracker clients do the same over Zenoh."""
    router = APIRouter(tags=["recording"])
    recorder = parts.recorder

    @router.get("/tasks/{task}/recording")
    def get_recording_state(task: str) -> list[dict[str, Any]]:
        """Return the accounts of the task's running recordings."""
        name = parts.store.task(task).name
        return [report_document(report) for report in recorder.reports() if report.task == name]

    @router.post("/tasks/{task}/recording", status_code=201)
    def start_recording(task: str, recording: Recording) -> dict[str, Any]:
        """Start recording from a tracker; demonstrations are cut by themselves as the hand grasps and releases."""
        return report_document(
            recorder.begin(
                task,
                recording.tracker,
                calibration=recording.calibration,
                rate=recording.rate,
                routine=Routine(recording.armed, recording.countdown, recording.takes, recording.one_by_one),
            )
        )

    @router.post("/tasks/{task}/recording/stop")
    def stop_recording(task: str, recording: Recording) -> dict[str, Any]:
        """Stop recording and return the account of every sample."""
        return report_document(recorder.end(of_task(task, recording.tracker), discard=recording.discard))

    @router.post("/tasks/{task}/recording/pause")
    def pause_recording(task: str, named: Named) -> dict[str, Any]:
        """Record nothing until `resume`; what is carried now is recorded to its end first."""
        return report_document(recorder.pause(of_task(task, named.tracker)))

    @router.post("/tasks/{task}/recording/resume")
    def resume_recording(task: str, named: Named) -> dict[str, Any]:
        """Record again."""
        return report_document(recorder.resume(of_task(task, named.tracker)))

    @router.post("/tasks/{task}/recording/discard")
    def discard_last(task: str) -> Demonstration:
        """Discard the newest demonstration that is kept; it is marked, not deleted."""
        return recorder.curation.discard_last(task)

    @router.post("/tasks/{task}/recording/restore")
    def restore_last(task: str) -> Demonstration:
        """Bring back the demonstration that was discarded last."""
        return recorder.curation.restore_last(task)

    def of_task(task: str, tracker: str) -> str:
        name = parts.store.task(task).name
        running = {report.tracker for report in recorder.reports() if report.task == name}
        if tracker not in running:
            raise UnusableInput(f"{tracker!r} is not recording {task}; running: {sorted(running) or 'none'}")
        return tracker

    return router
