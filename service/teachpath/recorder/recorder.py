"""The recorder: hand samples from the bus into recordings, cut into demonstrations, every sample counted."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import replace

from teachpath.errors import Conflict
from teachpath.io.bus import Bus, Handle
from teachpath.io.store.store import Store
from teachpath.recorder.annotations import Annotations
from teachpath.recorder.feedback import FeedbackPublisher
from teachpath.recorder.presence import Presence, Tracker
from teachpath.recorder.recording_setup import (
    DemonstrationCallbacks,
    Lookup,
    RecordingSetup,
    check_request,
    find_setup,
)
from teachpath.recorder.recording_thread import RecordingThread
from teachpath.recorder.recording_work import Call, call_directly
from teachpath.recorder.resumption import Resumption
from teachpath.recorder.row_queue import RowQueue
from teachpath.recorder.sample_queues import SampleQueues
from teachpath.recorder.sample_totals import RecordingTotals, SampleTotals
from teachpath.recorder.session import RecordingSession
from teachpath.recorder.suspendable_session import SuspendableSession
from teachpath.recorder.take import FinishedTake
from teachpath.recorder.touches import Touches
from teachpath.recorder.tracker_owners import TrackerOwners
from teachpath.recording.settings import RecordingSettings
from teachpath.records import (
    Amendment,
    RecordingRequest,
    RecordingState,
    RecordingStatus,
    StopRequest,
)
from teachpath_proto.keys import Keys

MAX_SHOWN_HANDS = 32  # more would hide each other

log: logging.Logger = logging.getLogger("teachpath")


class Recorder:
    """Turns sample streams into demonstrations; one running recording a tracker.

    Args:
        call: calls what reads a whole recording.
        clock: [s] monotonic.

    Attributes:
        annotations: changes stored demonstrations.
        owners: which session each tracker's name belongs to.
        rows: stores the rows of takes.
        touches: measures places that are touched with a tracker.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        store: Store,
        settings: RecordingSettings,
        lookup: Lookup,
        callbacks: DemonstrationCallbacks | None = None,
        *,
        call: Call = call_directly,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._store = store
        self._settings = settings
        self._lookup = lookup
        self._callbacks = callbacks or DemonstrationCallbacks()
        self._clock = clock
        self.owners: TrackerOwners = TrackerOwners(keys, clock)
        self._presence = Presence(clock)
        self.touches: Touches = Touches(keys, self._presence)
        self._queues = SampleQueues(keys, self._presence, settings.longest_backlog)
        self.rows: RowQueue = RowQueue(store)
        self._recording = RecordingThread(
            self._queues,
            self._presence,
            settings,
            on_finished=self._report_finished,
            on_discard_request=self._discard_last_of,
            rows=self.rows,
            clock=clock,
        )
        self.annotations: Annotations = Annotations(
            store, settings, lookup.scene, self._callbacks.changed, call, self._recording.wait_for_takes
        )
        self._feedback = FeedbackPublisher(bus, keys, self.statuses, store.demonstration, clock=clock)
        self._resumption = Resumption(
            bus,
            keys,
            store,
            self._queues,
            self._presence,
            self._recording,
            self._setup,
            self._new_session,
            settings.tracker_return_timeout,
            clock,
        )
        self._missed = 0
        self._totals = SampleTotals()
        self._handles: list[Handle] = []

    def start(self) -> None:
        """Go on with the recordings that the last stop left, and begin to listen."""
        self.rows.start()
        self._resumption.start()
        self._recording.start()
        self._feedback.start()
        self._handles = [
            self._bus.subscribe_with_source(self._keys.all_samples, self._on_sample, missed=self._count_missed),
            self._bus.watch(self._keys.all_trackers_alive, self._queues.on_liveliness),
        ]

    def stop(self) -> None:
        """Stop listening, keep what is complete, and leave every running recording for the next start."""
        for handle in self._handles:
            handle.close()
        self._resumption.stop()
        self._store.recordings.suspensions.keep(self._recording.stop())
        self.rows.stop()
        self._feedback.stop()

    def begin(self, request: RecordingRequest) -> RecordingStatus:
        """Start recording demonstrations of a task from a tracker.

        A task that does not exist is made when the request names a scene. A recording whose tracker was lost is ended
        first.

        Raises:
            UnusableInput: a name that cannot be a folder and a key, or a rate outside its limits.
            NotFound: no such task, scene or calibration.
            Conflict: this tracker is being recorded already, or the task is archived.
        """
        check_request(request)
        with self._recording.beginning:
            return self._begin(request)

    def _begin(self, request: RecordingRequest) -> RecordingStatus:
        if request.scene:
            self._lookup.scene(request.scene)
            calibration = self._lookup.calibration(request.calibration or "identity").name
            self._store.ensure_task(request.task, scene=request.scene, calibration=calibration)
        tracker, sessions = request.tracker, self._recording.sessions
        setup = self._setup(request)
        with self._recording.condition:
            before = sessions.get(tracker)
            if before is not None and not before.is_waiting:
                self._recording.drain(before)
            if before is not None and before.state is not RecordingState.LOST and not before.is_waiting:
                raise Conflict(f"{tracker} is already recording {before.task}; stop that first")
            session = self._new_session(setup)
            if before is not None:
                before.finish(torn=before.is_waiting)
                self._totals.end_recording(before.counter.statistics())
            sessions[tracker] = session
            self._queues.open(tracker)
            return session.status(with_statistics=True)

    def end(self, request: StopRequest) -> RecordingStatus:
        """End the recording of a tracker and return its status.

        Waits up to `handshake_timeout` for samples up to `last_sequence` that are still under way; those that do not
        come are lost. A demonstration whose object was released is kept.

        Raises:
            NotFound: the tracker is not being recorded.
        """
        tracker, last_sequence = request.tracker, request.last_sequence
        with (condition := self._recording.condition):
            session = self._recording.session(tracker)
            if last_sequence is not None:
                condition.wait_for(lambda: session.counter.highest >= last_sequence, self._settings.handshake_timeout)
            self._recording.drain(session)
            if last_sequence is not None:
                session.counter.count_missing_until(last_sequence)
            if self._recording.sessions.get(tracker) is session:
                del self._recording.sessions[tracker]
                self._queues.close(tracker)
                self._totals.end_recording(session.counter.statistics())
            session.finish(discard=request.discard)
        session.completer.wait()
        return replace(session.status(with_statistics=True), state=None, phase=None)

    def pause(self, tracker: str) -> RecordingStatus:
        """Record nothing from `tracker` until `resume`; what is carried now is recorded to its end first."""
        with self._recording.condition:
            session = self._recording.session(tracker)
            session.pause()
            return session.status(with_statistics=True)

    def resume(self, tracker: str) -> RecordingStatus:
        """Record from `tracker` again."""
        with self._recording.condition:
            session = self._recording.session(tracker)
            session.resume()
            return session.status(with_statistics=True)

    def statuses(self, *, with_statistics: bool = False) -> list[RecordingStatus]:
        """Return the status of every running recording, without its hand."""
        with self._recording.condition:
            return [session.status(with_statistics=with_statistics) for session in self._recording.sessions.values()]

    def shown_statuses(self) -> list[RecordingStatus]:
        """Return the status of the recordings whose hands are to be drawn, with them; at most `MAX_SHOWN_HANDS`."""
        with self._recording.condition:
            shown = list(self._recording.sessions.values())[:MAX_SHOWN_HANDS]
            return [session.status(with_hand=True) for session in shown]

    def totals(self) -> RecordingTotals:
        """Return what was recorded since the service began, over all recordings."""
        with self._recording.condition:
            running = [session.counter.statistics() for session in self._recording.sessions.values()]
            return self._totals.with_running(running)

    def wait_for_takes(self) -> None:
        """Wait until the takes that have ended are stored, or wait for the database; their recordings go on."""
        self._recording.wait_for_takes()

    def trackers(self) -> list[Tracker]:
        """Return the trackers that are there: those with a liveliness token, and those that send."""
        return self._presence.trackers()

    @property
    def backlog(self) -> int:
        """How many samples were received and not recorded yet; of each tracker at most `longest_backlog`."""
        return self._queues.backlog

    def faults(self) -> list[str]:
        """Say what keeps samples from being recorded now, for the operator."""
        with self._recording.condition:
            sessions = self._recording.sessions.values()
            found = [f"{session.tracker}: {session.fault}" for session in sessions if session.fault]
        if self._missed:
            found.append(f"Zenoh reports {self._missed} samples that never came")
        found += self.owners.faults() + self.rows.faults()
        return found + [sentence for sentence in [self._queues.invalid_names()] if sentence]

    def is_writing(self) -> bool:
        """Tell whether a recording runs, or a take that has ended is being completed."""
        return self._recording.is_writing()

    def kept_idle(self, task: str) -> AbstractContextManager[None]:
        """Let no recording of a task begin in the block, and all takes be stored; raises Conflict where not."""
        return self._recording.kept_idle(task)

    def task_of(self, tracker: str) -> str:
        """Return the task that `tracker` is recording; raises NotFound."""
        return self._recording.session(tracker).task

    def _setup(self, request: RecordingRequest) -> RecordingSetup:
        return find_setup(request, self._store, self._lookup)

    def _new_session(self, setup: RecordingSetup) -> SuspendableSession:
        completer = self._recording.take_queue()
        return SuspendableSession(self._store, self._settings, setup, completer=completer, clock=self._clock)

    def _on_sample(self, key: str, payload: bytes, source: str) -> None:  # on the transport's thread
        self._queues.on_sample(key, payload)
        self.touches.on_sample(key, payload)
        self.owners.on_sample(key, payload, source)

    def _count_missed(self, count: int) -> None:  # on the transport's thread
        self._missed += count

    def _report_finished(self, finished: FinishedTake) -> None:
        demonstration, trajectory = finished
        self._totals.end_take(demonstration.verdict)
        try:
            self._callbacks.added(demonstration, trajectory)
        except Exception:  # the display may fail; the demonstration is stored, and recording goes on
            log.exception("demonstration %s is stored, but could not be shown", demonstration.id)

    def _discard_last_of(self, session: RecordingSession) -> None:
        if self.rows.discard_newest(session.tracker):
            return
        kept = (key for key in reversed(session.demonstrations) if not self._store.demonstration(key).discarded_ns)
        if (newest := next(kept, None)) is not None:
            self.annotations.amend(newest, Amendment(discarded=True))
