"""One recording that is running: its account, its phases, and what the operator wants of it."""

from __future__ import annotations

import time
from collections.abc import Callable

from teachpath.io.store.recordings import RecordingHeader
from teachpath.io.store.store import Store
from teachpath.io.wire import encode_report
from teachpath.recorder.feedback import Standing
from teachpath.recorder.take import FinishedTake, Take
from teachpath.recording.demonstration import object_pose, point_to_world
from teachpath.recording.fist_gesture import FistCommand, FistGesture
from teachpath.recording.live_hand import Hand
from teachpath.recording.phases import TOGGLE_BUTTON, Segmenter, TransportSpan, hand_closure
from teachpath.recording.settings import RecordingSettings
from teachpath.recording.state_machine import RecordingState, RecordingStateMachine, Routine
from teachpath.recording.stream_statistics import StreamCounter
from teachpath.records import Calibration, Phase, Sample, Scene, Vector
from teachpath_proto import tracker_pb2


class RecordingSession:
    """Writes the samples of one tracker and cuts them; not thread-safe, its owner locks.

    Args:
        rate: [Hz] that the client declares; 0: it says nothing.
        routine: how takes follow each other.
        clock: [s] monotonic.

    Attributes:
        account: of every sample that came.
        demonstrations: ids of those made so far, in order.
        flushed: when its file was last flushed, by the clock.
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
        routine: Routine | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.task, self.tracker, self.calibration = task, tracker, calibration
        self._store, self._settings, self._clock = store, settings, clock
        # of the whole recording; its open part is that of the open take
        self.account = StreamCounter(declared_rate=rate, largest_clock_step=settings.largest_clock_step)
        self._state_machine = RecordingStateMachine(routine or Routine(), clock(), countdown=settings.countdown)
        self._thing = scene.carried
        self._carried = scene.carried.position if scene.carried else None
        self._to_world = point_to_world(calibration)
        self.demonstrations: list[str] = []
        self.last_flush = clock()
        self._idle = 0
        self._torn = self._pedal_was_used = self._unwanted = False
        self._buttons = self._takes = 0
        self._newest: Sample | None = None
        self._take = self._new_take()
        self._segmenter = Segmenter(settings, self._carried)
        self._gesture = FistGesture(settings, self._carried)

    @property
    def state(self) -> RecordingState:
        """What is done with the samples that come."""
        return self._state_machine.state

    @property
    def is_carrying(self) -> bool:
        """Whether a take is under way that would be missed: something is grasped, or has just been let go."""
        return self._segmenter.phase is not Phase.REACH

    @property
    def fault(self) -> str:
        """Why the open take is not written, or empty."""
        return self._take.fault

    def add(self, sample: Sample, payload: bytes = b"") -> FinishedTake | None:
        """Write one sample, `payload` as it came; return the demonstration that it completes."""
        fresh = self.account.observe(sample)
        if self.account.has_restarted:
            self._idle += 1
            return self.interrupt("the device began to count anew in mid-take")
        self._state_machine.on_sample()
        if fresh:
            self._newest = sample
        position = self._to_world(sample.position)
        if fresh:
            self._follow_signs(sample, position)
        if self.state is RecordingState.COUNTDOWN and self._state_machine.poll_countdown(self._clock()):
            self._drop()
        if self.state in (RecordingState.PAUSED, RecordingState.COUNTDOWN):
            self._idle += 1
            return None
        if not fresh:
            self._segmenter.skip()
            self._take.write(sample, payload)
            return None
        return self._follow_phases(sample, payload, position)

    def pause(self) -> None:
        """Record nothing until `resume`; what is carried now is recorded to its end first."""
        self._state_machine.pause(carrying=self.is_carrying)
        if self.state is RecordingState.PAUSED:
            self._drop()

    def resume(self) -> None:
        """Record again, after the countdown if there is one."""
        if self.state is RecordingState.PAUSED:
            self.account.begin_interval()
        self._state_machine.resume(self._clock())

    def interrupt(self, reason: str) -> FinishedTake | None:
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

    def on_tracker_lost(self, reason: str) -> FinishedTake | None:
        """Take note that the tracker has gone; as `interrupt`."""
        finished = self.interrupt(reason)
        self._state_machine.on_tracker_lost()
        return finished

    def refuse(self, reason: str) -> None:
        """Count a payload that is no sample."""
        self.account.refuse(reason)

    def expect(self, last_sequence: int) -> None:
        """Count as lost what was sent up to `last_sequence` and did not come."""
        self.account.expect(last_sequence)

    def note(self, sentence: str) -> None:
        """Keep a sentence with the recording and its open demonstration."""
        self.account.note(sentence)

    def flush(self, now: float) -> None:
        """Hand what was written to the operating system; when nothing could be written, try again."""
        self.last_flush = now
        if self._take.fault and not self.is_carrying:
            self._drop()
        self._take.flush()

    def fail(self, reason: str) -> None:
        """Stop writing the open take and leave its file as it is; the next one is tried again."""
        self._take.fail(reason)

    def finish(self, *, discard: bool = False, torn: bool = False) -> list[FinishedTake]:
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

    def pop_discard_request(self) -> bool:
        """Return, once, whether a fist has asked for the last demonstration to be discarded."""
        asked, self._unwanted = self._unwanted, False
        return asked

    def hand(self) -> Hand | None:
        """Return how the hand is seen now; None before its first sample and while it is not tracked."""
        newest, phase = self._newest, self._segmenter.phase
        if newest is None or not newest.tracked:
            return None
        carried = None
        if phase in (Phase.GRASP, Phase.TRANSPORT, Phase.RELEASE) and self._carried is not None:
            grasped = self._take.samples[self._segmenter.grasp]
            carried = object_pose(grasped, newest, self.calibration, self._carried)
        return Hand(
            tracker=self.tracker,
            received=self.account.received,
            take=self._takes,
            phase=phase,
            closed=hand_closure(newest) > self._settings.close_at,
            position=self._to_world(newest.position),
            thing=self._thing,
            carried=carried,
        )

    def report(self, *, ended: bool = False) -> tracker_pb2.RecordingReport:
        """Return the account of this recording so far."""
        return encode_report(
            self.task,
            self.tracker,
            self.demonstrations,
            self.account.statistics(),
            idle=self._idle,
            phase="" if ended else self._segmenter.phase.value,
            state="" if ended else self.state.value,
            pedal=self._pedal_was_used,
            countdown_left=self._state_machine.countdown_left(self._clock()),
            takes_left=self._state_machine.takes_left,
            sign=self._gesture.pending_command or "",
        )

    def standing(self) -> Standing:
        """Return what the hand and its operator should know at once."""
        return Standing(
            self.tracker,
            self.task,
            self._segmenter.phase.value,
            self.state.value,
            self._state_machine.countdown_left(self._clock()),
            self._state_machine.takes_left,
            len(self.demonstrations),
            self.demonstrations[-1] if self.demonstrations else "",
            self._gesture.pending_command or "",
        )

    def _follow_signs(self, sample: Sample, position: Vector) -> None:
        pressed = sample.buttons & TOGGLE_BUTTON and not self._buttons & TOGGLE_BUTTON
        self._buttons = sample.buttons
        self._pedal_was_used |= bool(pressed)
        sign = self._gesture.push(sample, position, carrying=self.is_carrying)
        self._unwanted |= sign is FistCommand.DISCARD
        if pressed or sign is FistCommand.TOGGLE:
            if self.state in (RecordingState.RECORDING, RecordingState.COUNTDOWN):
                self.pause()
            else:
                self.resume()

    def _follow_phases(self, sample: Sample, payload: bytes, position: Vector) -> FinishedTake | None:
        before = self._segmenter.phase
        cut = self._segmenter.push(sample, position)
        phase = self._segmenter.phase
        if cut is not None and phase is Phase.GRASP:  # the first sample of the next take
            finished = self._close(cut, following=sample)
            self._take.write(sample, payload)
            return finished
        self._take.write(sample, payload)
        if cut is not None:
            return self._close(cut)
        if phase is Phase.REACH:
            if before is Phase.GRASP:
                self.account.note("the hand opened where it had closed: nothing was carried")
            if self._take.seconds > self._settings.longest_reach:
                self._drop()
        return None

    def _close(self, cut: TransportSpan, *, fault: str = "", following: Sample | None = None) -> FinishedTake | None:
        # A device without a glove lets go by ending its recording; a glove would have shown the release.
        if cut.open_ended and not fault and (self._torn or self._take.samples[-1].flexions):
            fault = "the recording ended before the hand let go"
        finished = self._take.finalize(cut, self.account.interval(excluding=following), self._carried, fault)
        if finished is None:
            self._idle += len(self._take.samples)
        else:
            self.demonstrations.append(finished[0].id)
        self._state_machine.end_take(self._clock(), made=finished is not None)
        self._open_next(following)
        return finished

    def _drop(self) -> None:
        self._take.discard()
        self._idle += len(self._take.samples)
        self._open_next()
        self._segmenter = Segmenter(self._settings, self._carried)

    def _open_next(self, first: Sample | None = None) -> None:
        self._take = self._new_take()
        self.account.begin_interval(newest=first)

    def _new_take(self) -> Take:
        self._takes += 1
        header = RecordingHeader(self.task, self.tracker, self.calibration)
        return Take(self._store, self._settings, header, self.account.note)
