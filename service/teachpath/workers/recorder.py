"""The recorder: hand samples from the bus into recordings, cut into demonstrations, every sample accounted for."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable

from teachpath.errors import Conflict, NotFound, UnusableInput, UnusableSample
from teachpath.io.bus import Bus, Handle
from teachpath.io.store import Store
from teachpath.io.wire import decode_sample, parse
from teachpath.recording import RecordingSettings
from teachpath.records import Calibration, Demonstration, Scene, Trajectory
from teachpath.workers.session import RecordingSession
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys, is_name

FLUSH_EVERY = 1.0  # [s]

Recorded = Callable[[Demonstration, Trajectory], None]
Report = tracker_pb2.RecordingReport


class Recorder:
    """Turns sample streams into demonstrations; one running recording a tracker.

    Args:
        scene: gives the scene of a name; raises NotFound.
        calibration: gives the calibration of a name; raises NotFound.
        recorded: called on the recorder's thread with each new demonstration.
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
    ) -> None:
        self._bus, self._keys, self._store, self._settings = bus, keys, store, settings
        self._scene, self._calibration, self._recorded = scene, calibration, recorded
        self._inbox: queue.SimpleQueue[tuple[str, bytes, int] | None] = queue.SimpleQueue()
        self._changed = threading.Condition()
        self._sessions: dict[str, RecordingSession] = {}
        self._thread: threading.Thread | None = None
        self._handles: list[Handle] = []

    def start(self) -> None:
        """Begin to listen."""
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)
        self._thread.start()
        self._handles = [
            self._bus.subscribe(self._keys.all_samples, self._receive),
            self._bus.serve(self._keys.recorder_start, self._answer_start),
            self._bus.serve(self._keys.recorder_stop, self._answer_stop),
            self._bus.serve(self._keys.recorder_status, self._answer_status),
        ]

    def stop(self) -> None:
        """End every running recording, keeping what is complete, and stop listening."""
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

    def begin(self, task: str, tracker: str, *, calibration: str = "", scene: str = "") -> Report:
        """Start recording demonstrations of `task` from `tracker`.

        A task that does not exist is made when `scene` is named.

        Raises:
            UnusableInput: a name that cannot be a folder and a key.
            NotFound: no such task, scene or calibration.
            Conflict: this tracker is being recorded already.
        """
        for what, name in (("task", task), ("tracker", tracker)):
            if not is_name(name):
                raise UnusableInput(f"{name!r} cannot name a {what}: use letters, digits, '.', '_' or '-', at most 64")
        if scene:
            self._scene(scene)
            self._store.ensure_task(task, scene=scene, calibration=self._calibration(calibration or "identity").name)
        stored = self._store.task(task)
        with self._changed:
            if tracker in self._sessions:
                raise Conflict(f"{tracker} is already recording {self._sessions[tracker].task}; stop that first")
            session = RecordingSession(
                self._store,
                self._settings,
                task=task,
                tracker=tracker,
                calibration=self._calibration(calibration or stored.calibration),
                scene=self._scene(stored.scene),
            )
            self._sessions[tracker] = session
            return session.report()

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
            self._sessions.pop(tracker, None)
            finished = session.finish(discard=discard)
        for demonstration, trajectory in finished:
            self._recorded(demonstration, trajectory)
        return session.report(ended=True)

    def reports(self) -> list[Report]:
        """Return the accounts of all running recordings."""
        with self._changed:
            return [session.report() for session in self._sessions.values()]

    def calibration_of(self, tracker: str) -> Calibration | None:
        """Return the calibration under which `tracker` is being recorded, or None."""
        session = self._sessions.get(tracker)
        return session.calibration if session else None

    def _session(self, tracker: str) -> RecordingSession:
        session = self._sessions.get(tracker)
        if session is None:
            raise NotFound(f"{tracker!r} is not being recorded; running: {sorted(self._sessions) or 'none'}")
        return session

    def _receive(self, key: str, payload: bytes) -> None:
        # on the transport's thread: append only
        self._inbox.put((key, payload, time.time_ns()))

    def _run(self) -> None:
        flushed = time.monotonic()
        while True:
            try:
                item = self._inbox.get(timeout=FLUSH_EVERY / 4)
            except queue.Empty:
                item = ("", b"", 0)
            if item is None:
                return
            if item[0]:
                self._take_in(*item)
            if time.monotonic() - flushed >= FLUSH_EVERY:
                flushed = time.monotonic()
                with self._changed:
                    for session in self._sessions.values():
                        session.flush()

    def _take_in(self, key: str, payload: bytes, receive_ns: int) -> None:
        tracker = self._keys.tracker_of(key)
        finished: tuple[Demonstration, Trajectory] | None = None
        with self._changed:
            session = self._sessions.get(tracker)
            if session is None:
                return
            try:
                finished = session.add(decode_sample(tracker, payload, receive_ns))
            except UnusableSample as error:
                session.refuse(str(error))
            except Exception as error:  # one take's fault must not end the others
                session.fail(f"recording failed: {error!r}")
            self._changed.notify_all()
        if finished is not None:
            self._recorded(*finished)

    def _answer_start(self, payload: bytes) -> bytes:
        request = parse(tracker_pb2.StartRecording, payload)
        report = self.begin(request.task, request.tracker, calibration=request.calibration, scene=request.scene)
        return report.SerializeToString()

    def _answer_stop(self, payload: bytes) -> bytes:
        request = parse(tracker_pb2.StopRecording, payload)
        return self.end(
            request.tracker, last_sequence=request.last_sequence, discard=request.discard
        ).SerializeToString()

    def _answer_status(self, _: bytes) -> bytes:
        return tracker_pb2.RecorderStatus(recordings=self.reports()).SerializeToString()
