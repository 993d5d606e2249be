"""Recording: start, pause, stop, and take back the newest demonstration."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter
from pydantic import Field

from teachpath.api.closed import Body
from teachpath.api.parts import Parts
from teachpath.errors import UnusableInput
from teachpath.io.wire import recording_document
from teachpath.records import Demonstration, RecordingRequest, Routine, StopRequest


class Recording(Body):
    """A recording to start."""

    tracker: str = Field(description="name of the tracker that shows the task")
    calibration: str = Field("", description="instead of the task's own")
    rate: float = Field(0.0, ge=0.0, le=10_000.0, description="samples a second that it sends; 0 = not said")
    armed: bool = Field(False, description="paused, until pedal, fist or `resume` begins the first take")
    countdown: float | None = Field(None, ge=0.0, le=60.0, description="[s] before each take; else the setting")
    takes: int = Field(0, ge=0, le=10_000, description="pause by itself after so many demonstrations; 0 = never")
    one_by_one: bool = Field(False, description="pause after each demonstration")


class Ended(Body):
    """A recording to stop."""

    tracker: str = Field(description="name of the tracker that is recording the task")
    discard: bool = Field(False, description="throw away the demonstration that is still open")


class Named(Body):
    """A tracker whose recording is meant."""

    tracker: str = Field(description="name of the tracker that is recording the task")


def recording_router(parts: Parts) -> APIRouter:
    """Return the routes that start and stop recording; tracker clients do the same over Zenoh."""
    router = APIRouter(tags=["recording"])
    recorder = parts.recorder

    @router.get("/tasks/{task}/recording")
    def get_recording_state(task: str) -> list[dict[str, Any]]:
        """Return the accounts of the task's running recordings."""
        name = parts.store.task(task).name
        return [recording_document(s) for s in recorder.statuses(with_statistics=True) if s.task == name]

    @router.post("/tasks/{task}/recording", status_code=201)
    def start_recording(task: str, recording: Recording) -> dict[str, Any]:
        """Start recording from a tracker; demonstrations are cut by themselves as the hand grasps and releases."""
        return recording_document(
            recorder.begin(
                RecordingRequest(
                    task,
                    recording.tracker,
                    calibration=recording.calibration,
                    rate=recording.rate,
                    routine=Routine(recording.armed, recording.countdown, recording.takes, recording.one_by_one),
                )
            )
        )

    @router.post("/tasks/{task}/recording/stop")
    def stop_recording(task: str, ended: Ended) -> dict[str, Any]:
        """Stop recording and return the account of every sample."""
        return recording_document(recorder.end(StopRequest(of_task(task, ended.tracker), discard=ended.discard)))

    @router.post("/tasks/{task}/recording/pause")
    def pause_recording(task: str, named: Named) -> dict[str, Any]:
        """Record nothing until `resume`; what is carried now is recorded to its end first."""
        return recording_document(recorder.pause(of_task(task, named.tracker)))

    @router.post("/tasks/{task}/recording/resume")
    def resume_recording(task: str, named: Named) -> dict[str, Any]:
        """Record again."""
        return recording_document(recorder.resume(of_task(task, named.tracker)))

    @router.post("/tasks/{task}/recording/discard")
    def discard_last(task: str) -> Demonstration:
        """Discard the newest demonstration that is kept; it is marked, not deleted."""
        return recorder.annotations.discard_last(task)

    @router.post("/tasks/{task}/recording/restore")
    def restore_last(task: str) -> Demonstration:
        """Bring back the demonstration that was discarded last."""
        return recorder.annotations.restore_last(task)

    def of_task(task: str, tracker: str) -> str:
        name = parts.store.task(task).name
        running = {status.tracker for status in recorder.statuses() if status.task == name}
        if tracker not in running:
            raise UnusableInput(f"{tracker!r} is not recording {task}; running: {sorted(running) or 'none'}")
        return tracker

    return router
