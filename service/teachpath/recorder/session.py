"""One running recording: its sample counts, its phases and takes, and the commands of its operator."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from teachpath.io.store.store import Store
from teachpath.recorder.closed_take import ClosedTake, Completer, DirectCompleter
from teachpath.recorder.hand_commands import HandCommands
from teachpath.recorder.hand_state import NewestSample, carried_pose
from teachpath.recorder.object_place import ObjectPlace
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.take import FinishedTake, Take, TakeOutcome
from teachpath.recording.arrival import Arrival
from teachpath.recording.demonstration import point_to_world
from teachpath.recording.phases import Segmenter, TransportSpan, hand_closure
from teachpath.recording.reversed_order import ReversedOrder
from teachpath.recording.settings import RecordingSettings
from teachpath.recording.state_machine import RecordingStateMachine
from teachpath.recording.stream_statistics import StreamCounter
from teachpath.records import HandState, Phase, RecordingState, RecordingStatus, Sample, Vector


class RecordingSession:
    """Writes the samples of one tracker and cuts them into demonstrations; not thread-safe, its owner locks.

    Methods that may end a take return the demonstration that it makes, unless that is made later.

    Args:
        completer: completes takes; None: at once.
        clock: [s] monotonic.

    Attributes:
        counter: counts every sample, and keeps notes for the operator.
        demonstrations: ids of those made so far, in order.
        last_flush: time of the last flush of its file, by the clock.
    """

    def __init__(
        self,
        store: Store,
        settings: RecordingSettings,
        setup: RecordingSetup,
        *,
        completer: Completer | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.completer: Completer | DirectCompleter = completer or DirectCompleter(store.add_demonstration)
        self._store, self._settings, self._setup = store, settings, setup
        self._clock = clock
        # Its current interval is that of the open take.
        self.counter: StreamCounter = StreamCounter(
            declared_rate=setup.rate, largest_clock_step=settings.largest_clock_step
        )
        self._state_machine = RecordingStateMachine(setup.routine, clock(), countdown=settings.countdown)
        self._object = ObjectPlace(setup.scene.carried, setup.reported_object, at_grasp=setup.object_at_grasp)
        self._order = ReversedOrder()
        self._to_world = point_to_world(setup.calibration)
        self.demonstrations: list[str] = []
        self.last_flush: float = clock()
        self._idle = 0
        self._is_torn = False
        self._take_number = 0
        self._newest = NewestSample()
        self._take = self._new_take()
        self._segmenter = Segmenter(settings, self._object.expected)
        self._commands = HandCommands(settings, self._object.expected)
        self._status: RecordingStatus | None = None  # newest, without hand and statistics
        self._status_values: tuple[object, ...] = ()

    @property
    def task(self) -> str:
        """The task that is recorded."""
        return self._setup.task

    @property
    def tracker(self) -> str:
        """The tracker that is recorded."""
        return self._setup.tracker

    @property
    def state(self) -> RecordingState:
        """What is done with the samples that come."""
        return self._state_machine.state

    @property
    def is_carrying(self) -> bool:
        """Whether a take is under way that must not be lost: the hand has grasped, or has just released."""
        return self._segmenter.phase is not Phase.REACH

    @property
    def fault(self) -> str:
        """Why the open take is not written, or empty."""
        return self._take.fault

    def add(self, sample: Sample, payload: bytes = b"") -> FinishedTake | None:
        """Write one sample, `payload` as it came; return the demonstration that it completes."""
        counter, machine = self.counter, self._state_machine
        arrival = counter.observe(sample)
        if self._order.observe(sample):
            counter.note(self._order.hint)
        fresh = arrival is Arrival.IN_ORDER
        if counter.has_restarted:
            self._idle += 1
            return self.interrupt("the device began to count anew in mid-take")
        machine.on_sample()
        position = self._to_world(sample.position)
        if fresh:
            self._newest.keep((sample,))
            self._follow_commands(sample, position)
        if machine.state is RecordingState.COUNTDOWN and machine.poll_countdown(self._clock()):
            self._drop_take()
        past = arrival is not Arrival.CONFLICTING and counter.is_before_interval(sample.sequence)
        if past or not machine.state.is_writing:
            self._idle += 1
            return None
        if not fresh:
            self._segmenter.skip()
            self._take.write(sample, payload)
            if self._segmenter.phase is Phase.REACH and self._take.seconds_received > self._settings.longest_reach:
                self.counter.note("a long reach began anew: its samples came late or twice")  # they would fill memory
                self._drop_take()
            return None
        return self._follow_phases(sample, payload, position)

    def pause(self) -> None:
        """Record nothing until `resume`; if the hand carries the object now, its take is recorded to the end first."""
        self._state_machine.pause(carrying=self.is_carrying)
        if self.state is RecordingState.PAUSED:
            self._drop_take()

    def resume(self) -> None:
        """Record again, after the countdown if there is one."""
        if self.state is RecordingState.PAUSED:
            self.counter.begin_interval()
        self._state_machine.resume(self._clock())

    def interrupt(self, reason: str) -> FinishedTake | None:
        """End the open take because its samples ended, and return the demonstration that it makes.

        A take whose object was released before is whole, and repaired at best; a take whose object was still carried
        is rejected. No take becomes a shorter one without a note.
        """
        self.counter.note(reason)
        self.counter.interrupt()
        cut = self._segmenter.finish()
        finished = self._close_take(cut, fault=reason) if cut is not None else None
        self._drop_take()
        # A hand that comes back closed has grasped nothing since.
        self._segmenter = Segmenter(self._settings, self._object.expected, closed=True)
        return finished

    def on_tracker_lost(self, reason: str) -> FinishedTake | None:
        """End the open take because the tracker has gone; as `interrupt`."""
        finished = self.interrupt(reason)
        self._state_machine.on_tracker_lost()
        return finished

    def flush(self, now: float) -> None:
        """Hand all that was written to the operating system; after a failure, begin a new take that is tried again."""
        self.last_flush = now
        if self._take.fault and not self.is_carrying:
            self._drop_take()
        self._take.flush()

    def fail(self, reason: str) -> None:
        """Stop writing the open take and leave its file as it is; the next take is tried again."""
        self._take.fail(reason)

    def finish(self, *, discard: bool = False, torn: bool = False) -> list[FinishedTake]:
        """End the recording; return the demonstration that its end completes, if there is one.

        Args:
            discard: throw away the demonstration that is still open.
            torn: the stream was cut off, so that the release of a hand that is still closed was not seen.
        """
        self._is_torn = torn
        cut = None if discard else self._segmenter.finish()
        finished = self._close_take(cut) if cut is not None else None
        self._drop_take()
        return [finished] if finished else []

    def pop_discard_request(self) -> bool:
        """Return, once, whether a fist has commanded to discard the last demonstration."""
        return self._commands.pop_discard_request()

    def status(self, *, with_hand: bool = False, with_statistics: bool = False) -> RecordingStatus:
        """Return a snapshot; hand and statistics cost more than all the rest, and are left out unless asked for."""
        plain = self._plain_status()
        if not (with_hand or with_statistics):
            return plain
        hand, statistics = self._hand() if with_hand else None, self.counter.statistics() if with_statistics else None
        return replace(plain, hand=hand, statistics=statistics)

    def _plain_status(self) -> RecordingStatus:
        """Return the status, made anew only when it has changed: of hundreds of recordings it is asked often."""
        phase, machine, commands = self._segmenter.phase, self._state_machine, self._commands
        carried, hint = self._object.shape(grasped=phase.has_object), self._order.hint or self._segmenter.hint
        state, demonstrations = (machine.state, machine.countdown_left(self._clock())), tuple(self.demonstrations)
        rest = (machine.takes_left, commands.pending, commands.pedal_used, self._idle, carried)
        values = (state, phase, demonstrations, rest, hint)
        if self._status is None or values != self._status_values:
            self._status_values = values
            self._status = RecordingStatus(
                self.task, self.tracker, state[0], phase, demonstrations, state[1], *rest, hint=hint
            )
        return self._status

    def _hand(self) -> HandState | None:
        if (newest := self._newest.read()) is None or not newest.tracked:
            return None
        grasped = self._take.samples[self._segmenter.grasp] if self._segmenter.phase.has_object else None
        return HandState(
            position=self._to_world(newest.position),
            is_closed=hand_closure(newest) > self._settings.close_at,
            received=self.counter.received,
            take=self._take_number,
            carried_pose=carried_pose(grasped, newest, self._setup.calibration, self._object.start),
        )

    def _follow_commands(self, sample: Sample, position: Vector) -> None:
        """Do what the operator commands with pedal or fist."""
        if self._commands.push(sample, position, carrying=self.is_carrying):
            if self.state in (RecordingState.RECORDING, RecordingState.COUNTDOWN):
                self.pause()
            else:
                self.resume()

    def _follow_phases(self, sample: Sample, payload: bytes, position: Vector) -> FinishedTake | None:
        before = self._segmenter.phase
        self._look_for_object()
        cut = self._segmenter.push(sample, position)
        phase = self._segmenter.phase
        if cut is not None and phase is Phase.GRASP:  # the first sample of the next take
            finished = self._close_take(cut, following=sample)
            self._object.on_grasp(position)
            self._take.write(sample, payload)
            return finished
        if before is Phase.REACH and phase is Phase.GRASP:
            self._object.on_grasp(position)
        self._take.write(sample, payload)
        if cut is not None:
            return self._close_take(cut)
        if phase is Phase.REACH:
            if before is Phase.GRASP:
                self.counter.note("the hand opened where it had closed: nothing was carried")
            if self._take.seconds > self._settings.longest_reach:
                self._drop_take()
        return None

    def _look_for_object(self) -> None:
        if not self._segmenter.phase.has_object and self._object.has_moved():
            self._segmenter.carried = self._object.expected
            self._commands.on_object_moved(self._object.expected)

    def _close_take(
        self, cut: TransportSpan, *, fault: str = "", following: Sample | None = None
    ) -> FinishedTake | None:
        # A device without a glove releases by ending its recording; a glove would have shown the release.
        if cut.open_ended and not fault and (self._is_torn or self._take.samples[-1].flexions):
            fault = "the recording ended before the hand let go"
        take, statistics = self._take, self.counter.interval(excluding=following)
        expected = take.can_be_finalized(cut)
        settle = partial(self._settle, take, expected)
        closed = ClosedTake(take, cut, statistics, self._object.start, self._object.pose, fault, settle)
        self._state_machine.end_take(self._clock(), made=expected)
        self._begin_take(following)
        return self.completer.complete(closed)

    def _settle(self, take: Take, expected: bool, outcome: TakeOutcome) -> None:
        """Take note of what became of a take that was `expected` to be a demonstration; another may be open.

        One whose row waits is settled again when it is stored.
        """
        for note in outcome.notes:
            self.counter.note(note, in_interval=False)
        if outcome.finished is not None:
            self.demonstrations.append(outcome.finished[0].id)
        elif not outcome.row_waits:
            self._idle += len(take.samples)
            self._state_machine.withdraw_take(counted=expected)

    def _drop_take(self) -> None:
        self._take.discard()
        self._idle += len(self._take.samples)
        self._begin_take()
        self._segmenter = Segmenter(self._settings, self._object.expected)

    def _begin_take(self, first: Sample | None = None) -> None:
        self._take = self._new_take()
        self.counter.begin_interval(first=first)

    def _new_take(self) -> Take:
        self._take_number += 1
        return Take(
            self._store, self._settings, self._setup.header(self._object), self.counter.note, self._setup.new_id
        )
