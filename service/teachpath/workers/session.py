"""One recording that is running: a take, its account and its phases."""

from __future__ import annotations

import uuid
from enum import StrEnum

from teachpath.errors import UnusableRecording
from teachpath.io.store import RecordingHeader, Store, Take
from teachpath.io.wire import encode_report
from teachpath.recording import (
    TOGGLE_BUTTON,
    Cut,
    RecordingSettings,
    Segmenter,
    StreamAccount,
    point_to_world,
)
from teachpath.records import Calibration, Demonstration, Phase, Sample, Scene, Trajectory
from teachpath.workers.closing import TakenSamples, close_take
from teachpath_proto import tracker_pb2

Finished = tuple[Demonstration, Trajectory]


class State(StrEnum):
    """What a recording does with the samples that come."""

    RECORDING = "recording"
    PAUSING = "pausing"  # paused as soon as what is carried has been let go
    PAUSED = "paused"
    LOST = "lost"  # the tracker has gone; recording goes on when it comes back


class RecordingSession:
    """Writes the samples of one tracker and cuts them; not thread-safe, its owner locks.

    Args:
        rate: [Hz] that the client declares; 0: it says nothing.
        armed: begin paused.
    """

    def __init__(
        self,
        store: Store,
        settings: RecordingSettings,
        *,
        task: str,
        tracker: str,
        calibration: Calibration,
        scene: Scene,
        rate: float = 0.0,
        armed: bool = False,
    ) -> None:
        self.task, self.tracker, self.calibration = task, tracker, calibration
        self.state = State.PAUSED if armed else State.RECORDING
        self._store, self._settings = store, settings
        # of the whole recording; its open part is that of the open take
        self.account = StreamAccount(declared_rate=rate, largest_clock_step=settings.largest_clock_step)
        self._carried = scene.carried.position if scene.carried else None
        self._to_world = point_to_world(calibration)
        self._demonstrations: list[str] = []
        self._idle = 0
        self._fault = ""
        self._torn = self._pedal_was_used = False
        self._buttons = 0
        self._take: Take | None = None
        self._samples: list[Sample] = []
        self._segmenter = Segmenter(settings, self._carried)

    @property
    def is_carrying(self) -> bool:
        """Whether a take is under way that would be missed: something is grasped, or has just been let go."""
        return self._segmenter.phase is not Phase.REACH

    @property
    def fault(self) -> str:
        """Why the open take is not written, or empty."""
        return self._fault

    def add(self, sample: Sample, payload: bytes = b"") -> Finished | None:
        """Write one sample, `payload` as it came; return the demonstration that it completes."""
        fresh = self.account.observe(sample)
        if self.account.restarted:
            self._idle += 1
            return self.interrupt("the device began to count anew in mid-take")
        if self.state is State.LOST:
            self.state = State.RECORDING
        if fresh:
            self._follow_pedal(sample.buttons)
        if self.state is State.PAUSED:
            self._idle += 1
            return None
        self._write(sample, payload)
        self._samples.append(sample)
        if not fresh:
            self._segmenter.pass_over()
            return None
        cut = self._segmenter.push(sample, self._to_world(sample.position))
        if cut is not None:
            return self._close(cut)
        if self._segmenter.phase is Phase.REACH and self._reaches_too_long():
            self._drop()
        return None

    def pause(self) -> None:
        """Record nothing until `resume`; what is carried now is recorded to its end first."""
        if self.state is State.RECORDING and self.is_carrying:
            self.state = State.PAUSING
        elif self.state is not State.PAUSING:
            self.state = State.PAUSED
            self._drop()

    def resume(self) -> None:
        """Record again."""
        if self.state is State.PAUSED:
            self.account.begin_part()
        if self.state is not State.LOST:
            self.state = State.RECORDING

    def interrupt(self, reason: str) -> Finished | None:
        """End the open take because its samples ended, never as a silent short one; return what it makes.

        What was let go before is whole, and repaired at best; what was still carried is rejected.
        """
        self.account.note(reason)
        self.account.interrupt()
        cut = self._segmenter.finish()
        finished = self._close(cut, fault=reason) if cut is not None else None
        self._drop()
        # A hand that comes back closed has grasped nothing since.
        self._segmenter = Segmenter(self._settings, self._carried, closed=True)
        return finished

    def lose(self, reason: str) -> Finished | None:
        """Take note that the tracker has gone; as `interrupt`."""
        finished = self.interrupt(reason)
        if self.state in (State.RECORDING, State.PAUSING):
            self.state = State.LOST
        return finished

    def refuse(self, reason: str) -> None:
        """Count a payload that is no sample."""
        self.account.refuse(reason)

    def expect(self, last_sequence: int) -> None:
        """Count as lost what was sent up to `last_sequence` and did not come."""
        self.account.expect(last_sequence)

    def remark(self, sentence: str) -> None:
        """Keep a sentence with the recording and its open demonstration."""
        self.account.note(sentence)

    def flush(self) -> None:
        """Hand what was written to the operating system; when nothing could be written, try again."""
        if self._fault and not self.is_carrying:
            self._drop()
        if self._take is not None:
            try:
                self._take.flush()
            except OSError as error:
                self.fail(_cannot("written", error))

    def finish(self, *, discard: bool = False, torn: bool = False) -> list[Finished]:
        """End the recording; return the demonstration that its end completes, if there is one.

        Args:
            discard: throw away the demonstration that is still open.
            torn: the stream was cut off, so a hand that is still closed was never seen to release.
        """
        self._torn = torn
        cut = None if discard else self._segmenter.finish()
        finished = self._close(cut) if cut is not None else None
        self._drop()
        return [finished] if finished else []

    def report(self, *, ended: bool = False) -> tracker_pb2.RecordingReport:
        """Return the account of this recording so far."""
        return encode_report(
            self.task,
            self.tracker,
            self._demonstrations,
            self.account.account(),
            idle=self._idle,
            phase="" if ended else self._segmenter.phase.value,
            state="" if ended else self.state.value,
            pedal=self._pedal_was_used,
        )

    def fail(self, reason: str) -> None:
        """Stop writing the open take and leave its file as it is; the next one is tried again."""
        self._fault = reason
        self.account.note(reason)
        if self._take is not None:
            self._take.leave()
            self._take = None

    def _follow_pedal(self, buttons: int) -> None:
        pressed = buttons & TOGGLE_BUTTON and not self._buttons & TOGGLE_BUTTON
        self._buttons = buttons
        if pressed:
            self._pedal_was_used = True
            if self.state is State.RECORDING:
                self.pause()
            else:
                self.resume()

    def _write(self, sample: Sample, payload: bytes) -> None:
        if self._fault:
            return
        try:
            if self._take is None:
                self._id = f"demo-{uuid.uuid4().hex[:12]}"
                header = RecordingHeader(self.task, self.tracker, self.calibration)
                self._take = self._store.recordings.begin(self._id, header)
            self._take.write(sample, payload)
        except OSError as error:
            self.fail(_cannot("written", error))

    def _reaches_too_long(self) -> bool:
        reach_ns = self._samples[-1].device_ns - self._samples[0].device_ns
        return reach_ns > self._settings.longest_reach * 1e9

    def _close(self, cut: Cut, *, fault: str = "") -> Finished | None:
        """Finish the take as a demonstration; a take that cannot be one is dropped, with a note that says why."""
        try:
            if self._take is None:
                raise UnusableRecording(f"a demonstration was lost: {self._fault}")
            # A device without a glove lets go by ending its recording; a glove would have shown the release.
            if cut.open_ended and not fault and (self._torn or self._samples[-1].flexions):
                fault = "the recording ended before the hand let go"
            taken = TakenSamples(self._samples, cut, self.account.part(), self.calibration, self._carried, fault)
            finished = close_take(self._store, self._settings, self._take, taken, self._facts())
        except UnusableRecording as error:
            self.account.note(str(error))
            self._drop()
            return None
        except OSError as error:
            self.fail(_cannot("finished", error))
            self._drop()
            return None
        self._demonstrations.append(finished[0].id)
        self._open_next()
        if self.state is State.PAUSING:
            self.state = State.PAUSED
        return finished

    def _facts(self) -> dict[str, str]:
        return {"id": self._id, "task": self.task, "source": self.tracker}

    def _drop(self) -> None:
        if self._take is not None:
            self._take.discard()
        self._idle += len(self._samples)
        self._open_next()

    def _open_next(self) -> None:
        self._take = None
        self._fault = ""
        self._samples = []
        self.account.begin_part()
        self._segmenter = Segmenter(self._settings, self._carried)


def _cannot(what: str, error: OSError) -> str:
    return (
        f"the recording cannot be {what}: {error.strerror or error}; free space or mend the folder, then show it again"
    )
