"""Going on with the recordings that were running when the service was stopped.

The take in the hand is recorded again from its file. Trackers of ours keep the newest samples that they have sent;
what they sent while no service ran is asked of them as soon as they are back, and comes before what they send now.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from teachpath.errors import TeachpathError, UnusableSample
from teachpath.io.bus import Bus
from teachpath.io.store.salvage import RecordingHeader
from teachpath.io.store.store import Store
from teachpath.io.wire import decode_sample
from teachpath.periodic_thread import PeriodicThread
from teachpath.recorder.presence import Presence
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.recording_thread import RecordingThread
from teachpath.recorder.sample_queues import QueueItem, SampleQueues
from teachpath.recorder.suspendable_session import SuspendableSession
from teachpath.recorder.take import random_id
from teachpath.records import RecordingRequest, Sample, SuspendedRecording
from teachpath_proto.keys import Keys

UNANNOUNCED_WAIT = 1.0  # [s] after its first sample in which a tracker has announced itself, or never will
LOOK_INTERVAL = 0.1  # [s]

log: logging.Logger = logging.getLogger("teachpath")


class Resumption:
    """Goes on with recordings, and fetches what their trackers sent meanwhile.

    Args:
        setup: returns what a request records, and how.
        new_session: opens a session.
        return_timeout: [s] in which a tracker has to come back.
        clock: [s] monotonic.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        store: Store,
        queues: SampleQueues,
        presence: Presence,
        recording: RecordingThread,
        setup: Callable[[RecordingRequest], RecordingSetup],
        new_session: Callable[[RecordingSetup], SuspendableSession],
        return_timeout: float,
        clock: Callable[[], float],
    ) -> None:
        self._bus, self._keys, self._store = bus, keys, store
        self._queues, self._presence, self._recording = queues, presence, recording
        self._setup, self._new_session, self._clock = setup, new_session, clock
        self._return_timeout, self._began = return_timeout, 0.0
        self._heard: dict[SuspendableSession, float] = {}  # when a waiting tracker was first heard
        self._thread = PeriodicThread("resumption", LOOK_INTERVAL, self.look)

    def start(self) -> None:
        """Go on with what was suspended; call it before samples are received."""
        self._began = self._clock()
        suspensions = self._store.recordings.suspensions
        for before in suspensions.read():
            request = before.request
            try:
                session = self._open(before)
            except (TeachpathError, OSError) as error:
                suspensions.leave(before)
                reason = f"the recording of {request.task} by {request.tracker} does not go on: {error}"
                self._store.health.note_lost(reason)
                continue
            with self._recording.condition:
                self._recording.sessions[request.tracker] = session
                self._queues.open(request.tracker)
            log.info("the recording of %s by %s goes on", request.task, request.tracker)
        suspensions.forget()
        if self._waiting():
            self._thread.start()

    def stop(self) -> None:
        """Ask no tracker any more."""
        self._thread.stop()

    def look(self) -> None:
        """Let each recording go on whose tracker is back, and end the take of one that does not come."""
        now = self._clock()
        for session in self._waiting():
            if not self._queues.is_empty(session.tracker):
                self._heard.setdefault(session, now)
            is_unannounced = now - self._heard.get(session, now) > UNANNOUNCED_WAIT
            if self._presence.is_announced(session.tracker) or is_unannounced:
                self._catch_up(session)
            elif now - self._began > self._return_timeout:
                self._give_up(session)

    def _waiting(self) -> list[SuspendableSession]:
        with self._recording.condition:
            return [session for session in self._recording.sessions.values() if session.is_waiting]

    def _open(self, before: SuspendedRecording) -> SuspendableSession:
        suspensions = self._store.recordings.suspensions
        header, taken = suspensions.open(before)
        setup = self._setup(before.request)
        if header is not None:
            session = self._replay(before, setup, header, taken)
            if session is not None:
                suspensions.remove(before)
                session.counter.note("the service was stopped in mid-take, and started anew")
                return session
            suspensions.leave(before)
            where = f"{before.request.task} by {before.request.tracker}"
            self._store.health.note_lost(f"the take in the hand of {where} does not go on: its scene has changed")
        session = self._new_session(setup)
        session.go_on(before, ())
        return session

    def _replay(
        self,
        before: SuspendedRecording,
        setup: RecordingSetup,
        header: RecordingHeader,
        taken: Sequence[tuple[Sample, bytes]],
    ) -> SuspendableSession | None:
        """Record a take again as it was; None: with the scene and the settings of now it would be another one."""
        ids, is_live = iter((before.take,)), False
        session = self._new_session(
            replace(
                setup,
                new_id=lambda: next(ids, "") or random_id(),
                reported_object=lambda: setup.reported_object() if is_live else before.object_pose,
            )
        )
        header = replace(header, object_pose=session.header.object_pose)  # it may be told to lie elsewhere by now
        same = session.go_on(before, taken) and session.header == header
        is_live = True
        if same:
            return session
        session.finish(discard=True)
        return None

    def _catch_up(self, session: SuspendableSession) -> None:
        """Put what the tracker sent meanwhile before what it sends now, and let the recording go on."""
        tracker, missed = session.tracker, list[bytes]()
        try:
            missed = self._bus.history(self._keys.samples(tracker))
        except TeachpathError as error:
            session.counter.note(f"what the tracker sent while no service ran cannot be had: {error}")
        fetched = [(self._identity(tracker, payload), payload) for payload in missed]
        known = [identity for identity, _ in fetched]
        begin = len(known) - known[::-1].index(session.last) if session.last in known else 0
        with self._recording.condition:
            if not session.is_waiting or self._recording.sessions.get(tracker) is not session:
                return
            live = self._queues.pop(tracker, self._queues.max_length)
            twice = 0
            while twice < len(live) and self._is_known(tracker, live[twice], known):
                twice += 1
            items = [QueueItem(payload, time.time_ns()) for _, payload in fetched[begin:]]
            self._queues.put_first(tracker, [*items, *live[twice:]])
            self._presence.on_sample(tracker)
            session.is_waiting = False
        log.info("%d samples that %s sent while no service ran are recorded", len(items), tracker)

    def _is_known(self, tracker: str, item: QueueItem, known: Sequence[tuple[int, int] | None]) -> bool:
        return item.payload is not None and self._identity(tracker, item.payload) in known

    def _identity(self, tracker: str, payload: bytes) -> tuple[int, int] | None:
        """Return number and device time of a sample; None where it cannot be used."""
        try:
            sample = decode_sample(tracker, payload, time.time_ns())
        except UnusableSample:
            return None
        return sample.sequence, sample.device_ns

    def _give_up(self, session: SuspendableSession) -> None:
        with self._recording.condition:
            session.is_waiting = False
            limit = f"{self._return_timeout:g} s (recording.tracker_return_timeout)"
            session.on_tracker_lost(f"the tracker did not come back within {limit} of the service's start")
