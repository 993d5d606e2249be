"""Recording: start, pause, stop, and take back the newest demonstration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from fastapi import APIRouter, Response
from pydantic import Field

from teachpath.api.access import DEMONSTRATE, VIEW, Sender
from teachpath.api.answers import located
from teachpath.api.parts import Parts
from teachpath.api.problems import refusals
from teachpath.api.strict_requests import Body, named_in_body
from teachpath.errors import UnusableInput
from teachpath.io.documents import from_document
from teachpath.io.wire import recording_document
from teachpath.recorder.recorder import Recorder
from teachpath.records import (
    Demonstration,
    FistCommand,
    Phase,
    RecordingRequest,
    RecordingState,
    RecordingStatus,
    Routine,
    StopRequest,
)


class NewRecording(Body):
    """A recording to start."""

    tracker: str = Field(description="name of the tracker that shows the task")
    calibration: str = Field("", description="instead of the task's own")
    rate: float = Field(0.0, ge=0.0, le=10_000.0, description="samples a second that it sends; 0 = not said")
    armed: bool = Field(False, description="paused, until pedal, fist or `resume` begins the first take")
    countdown: float | None = Field(None, ge=0.0, le=60.0, description="[s] before each take; else the setting")
    takes: int = Field(0, ge=0, le=10_000, description="pause by itself after so many demonstrations; 0 = never")
    one_by_one: bool = Field(False, description="pause after each demonstration")


class RecordingEnd(Body):
    """A recording to stop."""

    tracker: str = Field(description="name of the tracker that is recording the task")
    discard: bool = Field(False, description="throw away the demonstration that is still open")


class TrackerChoice(Body):
    """The tracker whose recording is paused or resumed."""

    tracker: str = Field(description="name of the tracker that is recording the task")


@dataclass(frozen=True, slots=True)
class RecordingReport:
    """The account of a recording: all samples that came, and all that did not; times in nanoseconds.

    Attributes:
        task: name of the task.
        tracker: name of the tracker.
        demonstrations: ids of those made so far, in order.
        received: samples that came.
        lost: numbers that never came.
        duplicated: samples that came again.
        reordered: samples that came after newer ones.
        late: samples that came after the demonstration they belong to was cut, which is made without them.
        refused: samples that could not be used.
        untracked: samples in which the tracker did not see the hand.
        gaps: stretches of numbers that never came.
        missing: first and last of the numbers that never came, of the first 20 gaps.
        longest_gap_ns: longest time without a sample, device clock [ns].
        conflicts: samples whose number was taken, or contradicts their device time.
        clock_jumps: times that the device's clock jumped.
        declared_rate: [Hz] that the client said; 0: none.
        seen_rate: [Hz] numbers a second of the device's clock.
        clock_offset_ns: host clock minus device clock, with the least transit in it [ns].
        clock_uncertainty_ns: median transit time minus the least [ns].
        clock_rate: seconds of the device's clock in one of the host's; 0: not known.
        idle: samples that belong to no demonstration.
        phase: of the hand; empty when the recording has ended.
        state: what becomes of the samples; empty when the recording has ended.
        pedal_used: whether the pedal has been pressed in this recording.
        countdown_left: [s] until samples are recorded.
        takes_left: demonstrations until it pauses by itself; 0: nobody has said how many.
        pending_command: what the fist that is held now commands when it opens; empty: nothing.
        notes: what an operator should know, in words.
    """

    task: str
    tracker: str
    demonstrations: tuple[str, ...]
    received: int
    lost: int
    duplicated: int
    reordered: int
    late: int
    refused: int
    untracked: int
    gaps: int
    missing: tuple[tuple[int, int], ...]
    longest_gap_ns: int
    conflicts: int
    clock_jumps: int
    declared_rate: float
    seen_rate: float
    clock_offset_ns: int
    clock_uncertainty_ns: int
    clock_rate: float
    idle: int
    phase: Phase | Literal[""]
    state: RecordingState | Literal[""]
    pedal_used: bool
    countdown_left: float
    takes_left: int
    pending_command: FistCommand | Literal[""]
    notes: tuple[str, ...]


def recording_router(parts: Parts) -> APIRouter:
    """Return the routes that start and stop recording; tracker clients do the same over Zenoh."""
    router = APIRouter(tags=["recording"])
    _add_recordings(router, parts)
    _add_newest(router, parts.recorder)
    return router


def _add_recordings(router: APIRouter, parts: Parts) -> None:
    recorder = parts.recorder

    @router.get("/tasks/{task}/recording", dependencies=VIEW)
    def get_recording_state(task: str) -> list[RecordingReport]:
        """Return the accounts of the task's running recordings."""
        name = parts.store.task(task).name
        return [_report(s) for s in recorder.statuses(with_statistics=True) if s.task == name]

    @router.post(
        "/tasks/{task}/recording",
        status_code=201,
        responses=refusals(409, 507) | located(201, "the running recordings of the task"),
        dependencies=DEMONSTRATE,
    )
    def start_recording(task: str, recording: NewRecording, response: Response) -> RecordingReport:
        """Start recording from a tracker; demonstrations are cut by themselves as the hand grasps and releases."""
        if recording.calibration:
            with named_in_body("calibration"):
                parts.calibrations.get(recording.calibration)
        response.headers["Location"] = f"/api/v1/tasks/{task}/recording"
        return _report(
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

    @router.post("/tasks/{task}/recording/stop", responses=refusals(507), dependencies=DEMONSTRATE)
    def stop_recording(task: str, end: RecordingEnd) -> RecordingReport:
        """Stop recording and return the account of every sample."""
        return _report(recorder.end(StopRequest(of_task(task, end.tracker), discard=end.discard)))

    @router.post("/tasks/{task}/recording/pause", dependencies=DEMONSTRATE)
    def pause_recording(task: str, choice: TrackerChoice) -> RecordingReport:
        """Pause until `resume`; an object that is being carried is recorded until it is released."""
        return _report(recorder.pause(of_task(task, choice.tracker)))

    @router.post("/tasks/{task}/recording/resume", dependencies=DEMONSTRATE)
    def resume_recording(task: str, choice: TrackerChoice) -> RecordingReport:
        """Resume a paused recording."""
        return _report(recorder.resume(of_task(task, choice.tracker)))

    def of_task(task: str, tracker: str) -> str:
        """Return a tracker that records this task; raises UnusableInput for another."""
        name = parts.store.task(task).name
        running = {status.tracker for status in recorder.statuses() if status.task == name}
        if tracker not in running:
            raise UnusableInput(f"{tracker!r} is not recording {task}; running: {sorted(running) or 'none'}")
        return tracker


def _add_newest(router: APIRouter, recorder: Recorder) -> None:
    @router.post("/tasks/{task}/recording/discard", responses=refusals(507), dependencies=DEMONSTRATE)
    def discard_last(task: str, sender: Sender) -> Demonstration:
        """Discard the newest demonstration that is kept; it is marked, not deleted."""
        return recorder.annotations.discard_last(task, who=sender.name)

    @router.post("/tasks/{task}/recording/restore", responses=refusals(507), dependencies=DEMONSTRATE)
    def restore_last(task: str, sender: Sender) -> Demonstration:
        """Bring back the demonstration that was discarded last."""
        return recorder.annotations.restore_last(task, who=sender.name)


def _report(status: RecordingStatus) -> RecordingReport:
    return from_document(RecordingReport, recording_document(status))
