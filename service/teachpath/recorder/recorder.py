"""The recorder: hand samples from the bus into recordings, cut into demonstrations, every sample accounted for."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable

from teachpath.errors import Conflict, UnusableInput
from teachpath.io.bus import Bus, Handle
from teachpath.io.store.store import Store
from teachpath.recorder.annotations import Amendment, Annotations
from teachpath.recorder.feedback import FeedbackPublisher, Standing
from teachpath.recorder.presence import Presence, Tracker
from teachpath.recorder.queries import RecorderQueries
from teachpath.recorder.recording_thread import RecordingThread
from teachpath.recorder.sample_queues import SampleQueues
from teachpath.recorder.session import RecordingSession
from teachpath.recorder.take import FinishedTake
from teachpath.recording.live_hand import Hand
from teachpath.recording.settings import RecordingSettings
from teachpath.recording.state_machine import RecordingState, Routine
from teachpath.records import Calibration, Demonstration, Scene, Trajectory
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys, is_name, name_refusal

MAX_SHOWN_HANDS = 32  # that are shown; more would hide each other

log = logging.getLogger("teachpath")
OnDemonstration = Callable[[Demonstration, Trajectory], None]
Report = tracker_pb2.RecordingReport


class Recorder:
    """Turns sample streams into demonstrations; one running recording a tracker.

    Args:
        scene: gives the scene of a name; raises NotFound.
        calibration: gives the calibration of a name; raises NotFound.
        on_change: called with each demonstration that an operator has discarded, restored, marked or trimmed.
        on_demonstration: called with each new demonstration, synchronously on the recorder thread or on the thread that
            called `begin` or `end`; it must not block.
        clock: [s] monotonic.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        store: Store,
        settings: RecordingSettings,
        *,
        scene: Callable[[str], Scene],
        calibration: Callable[[str], Calibration],
        on_demonstration: OnDemonstration = lambda demonstration, trajectory: None,
        on_change: Callable[[Demonstration], None] = lambda demonstration: None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._bus, self._keys, self._store, self._settings = bus, keys, store, settings
        self._scene, self._calibration, self._on_demonstration, self._clock = (
            scene,
            calibration,
            on_demonstration,
            clock,
        )
        self.annotations = Annotations(store, settings, scene, on_change)
        self._queries = RecorderQueries(bus, keys, self)
        self._presence = Presence(clock)
        self._queues = SampleQueues(keys, self._presence, settings.longest_backlog)
        self._recording_thread = RecordingThread(
            self._queues,
            self._presence,
            settings,
            on_finished=self._publish_finished,
            on_discard_request=self._discard_last_of,
            clock=clock,
        )
        self._feedback = FeedbackPublisher(bus, keys, self.standings, store.demonstration, clock=clock)
        self._missed = 0
        self._handles: list[Handle] = []

    def start(self) -> None:
        """Begin to listen."""
        self._recording_thread.start()
        self._feedback.start()
        self._handles = [
            self._bus.subscribe(self._keys.all_samples, self._queues.on_sample, missed=self._count_missed),
            self._bus.watch(self._keys.all_trackers_alive, self._queues.on_liveliness),
        ]
        self._queries.start()

    def stop(self) -> None:
        """End every running recording, keeping what is complete, and stop listening."""
        self._queries.stop()
        for handle in self._handles:
            handle.close()
        self._recording_thread.stop()
        self._feedback.stop()

    def begin(
        self,
        task: str,
        tracker: str,
        *,
        calibration: str = "",
        scene: str = "",
        rate: float = 0.0,
        routine: Routine | None = None,
    ) -> Report:
        """Start recording demonstrations of `task` from `tracker`.

        A task that does not exist is made when `scene` is named. A recording whose tracker has gone gives way.

        Args:
            rate: [Hz] that the client declares; 0: it says nothing.
            routine: how takes follow each other; None: one after the other, counted down as the settings say.

        Raises:
            UnusableInput: a name that cannot be a folder and a key, or no rate.
            NotFound: no such task, scene or calibration.
            Conflict: this tracker is being recorded already.
        """
        for what, name in (("task", task), ("tracker", tracker)):
            if not is_name(name):
                raise UnusableInput(name_refusal(what, name))
        if not 0.0 <= rate <= 10_000.0:
            raise UnusableInput(f"a rate of {rate:g} Hz is outside 0 (not said) to 10000")
        if scene:
            self._scene(scene)
            self._store.ensure_task(task, scene=scene, calibration=self._calibration(calibration or "identity").name)
        stored = self._store.task(task)
        with self._recording_thread.condition:
            before = self._recording_thread.sessions.get(tracker)
            finished = self._recording_thread.drain(before) if before is not None else []
            if before is not None and before.state is not RecordingState.LOST:
                raise Conflict(f"{tracker} is already recording {before.task}; stop that first")
            session = RecordingSession(
                self._store,
                self._settings,
                task=task,
                tracker=tracker,
                calibration=self._calibration(calibration or stored.calibration),
                scene=self._scene(stored.scene),
                rate=rate,
                routine=routine,
                clock=self._clock,
            )
            finished += before.finish() if before is not None else []
            self._recording_thread.sessions[tracker] = session
            self._queues.open(tracker)
            report = session.report()
        self._publish_finished(finished)
        return report

    def end(self, tracker: str, *, last_sequence: int | None = None, discard: bool = False) -> Report:
        """End the recording of `tracker` and return its account.

        Waits up to `handshake_timeout` for samples up to `last_sequence` that are still under way; those that do not
        come are lost. A demonstration whose object was released is kept; one still open is thrown away on `discard`.
        """
        with self._recording_thread.condition:
            session = self._recording_thread.session(tracker)
            if last_sequence is not None:
                arrived = lambda: session.account.highest >= last_sequence  # noqa: E731
                self._recording_thread.condition.wait_for(arrived, timeout=self._settings.handshake_timeout)
            finished = self._recording_thread.drain(session)
            if last_sequence is not None:
                session.expect(last_sequence)
            if self._recording_thread.sessions.get(tracker) is session:
                del self._recording_thread.sessions[tracker]
                self._queues.close(tracker)
            finished += session.finish(discard=discard)
        self._publish_finished(finished)
        return session.report(ended=True)

    def pause(self, tracker: str) -> Report:
        """Record nothing from `tracker` until `resume`; what is carried now is recorded to its end first."""
        with self._recording_thread.condition:
            session = self._recording_thread.session(tracker)
            session.pause()
            return session.report()

    def resume(self, tracker: str) -> Report:
        """Record from `tracker` again."""
        with self._recording_thread.condition:
            session = self._recording_thread.session(tracker)
            session.resume()
            return session.report()

    def reports(self) -> list[Report]:
        """Return the accounts of all running recordings."""
        with self._recording_thread.condition:
            return [session.report() for session in self._recording_thread.sessions.values()]

    def standings(self) -> list[Standing]:
        """Return how each running recording stands, for its hand."""
        with self._recording_thread.condition:
            return [session.standing() for session in self._recording_thread.sessions.values()]

    def trackers(self) -> list[Tracker]:
        """Return the trackers that are there: those that say so, and those that send."""
        return self._presence.trackers()

    @property
    def backlog(self) -> int:
        """How many samples have been received and not yet recorded; of each tracker at most `longest_backlog`."""
        return self._queues.backlog

    def faults(self) -> list[str]:
        """Say what keeps samples from being recorded now, for the operator."""
        with self._recording_thread.condition:
            found = [
                f"{session.tracker}: {session.fault}"
                for session in self._recording_thread.sessions.values()
                if session.fault
            ]
        if self._missed:
            found.append(f"Zenoh reports {self._missed} samples that never came")
        return found + [said for said in [self._queues.invalid_names()] if said]

    def hands(self) -> list[Hand]:
        """Return the hands that are recorded, as they are seen now; at most `MAX_SHOWN_HANDS`."""
        with self._recording_thread.condition:
            seen = [session.hand() for session in list(self._recording_thread.sessions.values())[:MAX_SHOWN_HANDS]]
        return [hand for hand in seen if hand is not None]

    def task_of(self, tracker: str) -> str:
        """Return the task that `tracker` is recording; raises NotFound."""
        return self._recording_thread.session(tracker).task

    def _count_missed(self, count: int) -> None:  # on the transport's thread
        self._missed += count

    def _publish_finished(self, finished: list[FinishedTake]) -> None:
        for demonstration, trajectory in finished:
            try:
                self._on_demonstration(demonstration, trajectory)
            except Exception:  # whoever shows it may fail; the demonstration is stored, and recording goes on
                log.exception("demonstration %s is stored, but could not be shown", demonstration.id)

    def _discard_last_of(self, session: RecordingSession) -> None:
        for key in reversed(session.demonstrations):
            if not self._store.demonstration(key).discarded_ns:
                self.annotations.amend(key, Amendment(discarded=True))
                return
