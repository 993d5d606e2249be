"""The recorder: hand samples from the bus into recordings, cut into demonstrations, every sample accounted for."""

from __future__ import annotations

import logging
import queue
import threading
import time
from collections.abc import Callable

from teachpath.errors import Conflict, NotFound, UnusableInput, UnusableSample
from teachpath.io.bus import Bus, Handle
from teachpath.io.store import Store
from teachpath.io.wire import decode_sample
from teachpath.recording import RecordingSettings
from teachpath.records import Calibration, Demonstration, Scene, Trajectory
from teachpath.workers.curation import Curation
from teachpath.workers.presence import Presence, Tracker
from teachpath.workers.recorder_queries import RecorderQueries
from teachpath.workers.session import Finished, RecordingSession
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys, is_name

FLUSH_EVERY = 0.75  # [s] under a second, with a margin for a busy machine
LOOK_EVERY = 0.2  # [s] for trackers that have fallen silent

log = logging.getLogger("teachpath")
Recorded = Callable[[Demonstration, Trajectory], None]
Report = tracker_pb2.RecordingReport


class Recorder:
    """Turns sample streams into demonstrations; one running recording a tracker.

    Args:
        scene: gives the scene of a name; raises NotFound.
        calibration: gives the calibration of a name; raises NotFound.
        changed: called with each demonstration that an operator has discarded, restored, marked or trimmed.
        recorded: called with each new demonstration, on the recorder's thread or that of the caller of `end`.
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
        recorded: Recorded = lambda demonstration, trajectory: None,
        changed: Callable[[Demonstration], None] = lambda demonstration: None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._bus, self._keys, self._store, self._settings = bus, keys, store, settings
        self._scene, self._calibration, self._recorded, self._clock = scene, calibration, recorded, clock
        self.curation = Curation(store, settings, scene, changed)
        self._queries = RecorderQueries(bus, keys, self)
        # (key, payload of a sample or whether a tracker is alive, when it was received)
        self._inbox: queue.SimpleQueue[tuple[str, bytes | bool, int] | None] = queue.SimpleQueue()
        self._changed = threading.Condition()
        self._sessions: dict[str, RecordingSession] = {}
        self._presence = Presence(clock)
        self._missed = 0
        self._thread: threading.Thread | None = None
        self._handles: list[Handle] = []

    def start(self) -> None:
        """Begin to listen."""
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)
        self._thread.start()
        self._handles = [
            self._bus.subscribe(self._keys.all_samples, self._receive, missed=self._miss),
            self._bus.watch(self._keys.all_trackers_alive, self._come_or_go),
        ]
        self._queries.start()

    def stop(self) -> None:
        """End every running recording, keeping what is complete, and stop listening."""
        self._queries.stop()
        for handle in self._handles:
            handle.close()
        if self._thread is not None:
            self._inbox.put(None)
            self._thread.join()
            self._thread = None
        with self._changed:
            for session in self._sessions.values():
                session.finish()
            self._sessions.clear()

    def begin(
        self,
        task: str,
        tracker: str,
        *,
        calibration: str = "",
        scene: str = "",
        rate: float = 0.0,
        armed: bool = False,
    ) -> Report:
        """Start recording demonstrations of `task` from `tracker`.

        A task that does not exist is made when `scene` is named. A recording whose tracker has gone gives way.

        Args:
            rate: [Hz] that the client declares; 0: it says nothing.
            armed: begin paused; the pedal or `resume` begins the first take.

        Raises:
            UnusableInput: a name that cannot be a folder and a key, or no rate.
            NotFound: no such task, scene or calibration.
            Conflict: this tracker is being recorded already.
        """
        for what, name in (("task", task), ("tracker", tracker)):
            if not is_name(name):
                raise UnusableInput(f"{name!r} cannot name a {what}: use letters, digits, '.', '_' or '-', at most 64")
        if not 0.0 <= rate <= 10_000.0:
            raise UnusableInput(f"a rate of {rate:g} Hz is outside 0 (not said) to 10000")
        if scene:
            self._scene(scene)
            self._store.ensure_task(task, scene=scene, calibration=self._calibration(calibration or "identity").name)
        stored = self._store.task(task)
        with self._changed:
            before = self._sessions.get(tracker)
            if before is not None and before.state != "lost":
                raise Conflict(f"{tracker} is already recording {before.task}; stop that first")
            session = RecordingSession(
                self._store,
                self._settings,
                task=task,
                tracker=tracker,
                calibration=self._calibration(calibration or stored.calibration),
                scene=self._scene(stored.scene),
                rate=rate,
                armed=armed,
            )
            finished = before.finish() if before is not None else []
            self._sessions[tracker] = session
            report = session.report()
        self._hand_out(finished)
        return report

    def end(self, tracker: str, *, last_sequence: int | None = None, discard: bool = False) -> Report:
        """End the recording of `tracker` and return its account.

        Waits up to `handshake_timeout` for samples up to `last_sequence` that are still under way; those that do not
        come are lost. A demonstration whose object was released is kept; one still open is thrown away on `discard`.
        """
        with self._changed:
            session = self._session(tracker)
            if last_sequence is not None:
                arrived = lambda: session.account.highest >= last_sequence  # noqa: E731
                self._changed.wait_for(arrived, timeout=self._settings.handshake_timeout)
                session.expect(last_sequence)
            if self._sessions.get(tracker) is session:
                del self._sessions[tracker]
            finished = session.finish(discard=discard)
        self._hand_out(finished)
        return session.report(ended=True)

    def pause(self, tracker: str) -> Report:
        """Record nothing from `tracker` until `resume`; what is carried now is recorded to its end first."""
        with self._changed:
            session = self._session(tracker)
            session.pause()
            return session.report()

    def resume(self, tracker: str) -> Report:
        """Record from `tracker` again."""
        with self._changed:
            session = self._session(tracker)
            session.resume()
            return session.report()

    def reports(self) -> list[Report]:
        """Return the accounts of all running recordings."""
        with self._changed:
            return [session.report() for session in self._sessions.values()]

    def trackers(self) -> list[Tracker]:
        """Return the trackers that are there: those that say so, and those that send."""
        return self._presence.trackers()

    @property
    def backlog(self) -> int:
        """How many samples have been received and not yet recorded."""
        return self._inbox.qsize()

    def faults(self) -> list[str]:
        """Say what keeps samples from being recorded now, for the operator."""
        with self._changed:
            found = [f"{session.tracker}: {session.fault}" for session in self._sessions.values() if session.fault]
        return found + ([f"Zenoh reports {self._missed} samples that never came"] if self._missed else [])

    def calibration_of(self, tracker: str) -> Calibration | None:
        """Return the calibration under which `tracker` is being recorded, or None."""
        session = self._sessions.get(tracker)
        return session.calibration if session else None

    def task_of(self, tracker: str) -> str:
        """Return the task that `tracker` is recording; raises NotFound."""
        return self._session(tracker).task

    def _session(self, tracker: str) -> RecordingSession:
        session = self._sessions.get(tracker)
        if session is None:
            raise NotFound(f"{tracker!r} is not being recorded; running: {sorted(self._sessions) or 'none'}")
        return session

    # on the transport's threads: append only

    def _receive(self, key: str, payload: bytes) -> None:
        self._inbox.put((key, payload, time.time_ns()))

    def _come_or_go(self, key: str, alive: bool) -> None:
        self._inbox.put((key, alive, 0))

    def _miss(self, count: int) -> None:
        self._missed += count

    # on the recorder's thread

    def _run(self) -> None:
        flushed = looked = self._clock()
        while True:
            try:
                item = self._inbox.get(timeout=LOOK_EVERY)
            except queue.Empty:
                item = ("", b"", 0)
            if item is None:
                return
            if item[0]:
                self._take_in(*item)
            now = self._clock()
            if now - flushed >= FLUSH_EVERY:
                flushed = now
                with self._changed:
                    for session in self._sessions.values():
                        session.flush()
            # Samples that wait are no silence.
            if now - looked >= LOOK_EVERY and self._inbox.empty():
                looked = now
                self._look_for_silence()

    def _take_in(self, key: str, content: bytes | bool, receive_ns: int) -> None:
        if isinstance(content, bool):
            self._follow(self._keys.announced(key), content)
            return
        tracker = self._keys.tracker_of(key)
        self._presence.hear(tracker)
        finished: Finished | None = None
        with self._changed:
            session = self._sessions.get(tracker)
            if session is None:
                return
            try:
                finished = session.add(decode_sample(tracker, content, receive_ns), content)
            except UnusableSample as error:
                session.refuse(str(error))
            except Exception as error:  # one take's fault must not end the others
                session.fail(f"recording failed: {error!r}")
            self._changed.notify_all()
        if finished is not None:
            self._hand_out([finished])

    def _follow(self, tracker: str, alive: bool) -> None:
        self._presence.announce(tracker, alive)
        if not alive:
            self._lose(tracker, "the tracker has gone in mid-take")

    def _look_for_silence(self) -> None:
        limit = self._settings.longest_silence
        carrying = [t for t, session in list(self._sessions.items()) if session.is_carrying]
        for tracker in carrying:
            if self._presence.silence_of(tracker) > limit:
                self._lose(tracker, f"no sample came for {limit:g} s in mid-take")

    def _lose(self, tracker: str, reason: str) -> None:
        with self._changed:
            session = self._sessions.get(tracker)
            if session is None:
                return
            try:
                finished = session.lose(reason if session.is_carrying else "the tracker has gone")
            except Exception as error:  # one take's fault must not end the others
                finished = None
                session.fail(f"recording failed: {error!r}")
        if finished is not None:
            self._hand_out([finished])

    def _hand_out(self, finished: list[Finished]) -> None:
        for demonstration, trajectory in finished:
            try:
                self._recorded(demonstration, trajectory)
            except Exception:  # whoever shows it may fail; the demonstration is stored, and recording goes on
                log.exception("demonstration %s is stored, but could not be shown", demonstration.id)
