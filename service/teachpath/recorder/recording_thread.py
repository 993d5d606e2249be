"""The thread that records the samples that were received, one tracker after the other."""

from __future__ import annotations

import threading
from collections.abc import Callable

from teachpath.errors import NotFound, UnusableSample
from teachpath.io.wire import decode_sample
from teachpath.periodic_thread import PeriodicThread
from teachpath.recorder.presence import Presence
from teachpath.recorder.sample_queues import QueueItem, SampleQueues
from teachpath.recorder.session import RecordingSession
from teachpath.recorder.take import FinishedTake
from teachpath.recording.settings import RecordingSettings

FLUSH_INTERVAL = 0.75  # [s] under a second, with a margin for a busy machine
ROUND_INTERVAL = 0.02  # [s] pause between two rounds; none while more samples wait than one round records
BATCH_SIZE = 200  # samples of one tracker that are recorded before the turn of the next


class RecordingThread:
    """Holds the running recordings, one a tracker, and writes into them the samples that wait in the queues.

    Args:
        on_finished: called with new demonstrations, on this thread.
        on_discard_request: called with a recording whose hand commands to discard its last demonstration.
        clock: [s] monotonic.

    Attributes:
        sessions: the running recordings by tracker; used only while `condition` is held.
        condition: notified whenever samples have been recorded.
    """

    def __init__(
        self,
        queues: SampleQueues,
        presence: Presence,
        settings: RecordingSettings,
        *,
        on_finished: Callable[[list[FinishedTake]], None],
        on_discard_request: Callable[[RecordingSession], None],
        clock: Callable[[], float],
    ) -> None:
        self._queues = queues
        self._presence = presence
        self._settings = settings
        self._on_finished = on_finished
        self._on_discard_request = on_discard_request
        self._clock = clock
        self.sessions: dict[str, RecordingSession] = {}
        self.condition = threading.Condition()
        self._thread = PeriodicThread("recorder", ROUND_INTERVAL, self.process_round)

    def start(self) -> None:
        """Record from now on."""
        self._thread.start()

    def stop(self) -> None:
        """Record the samples that still wait, end every recording, and stop; a second call does nothing."""
        self._thread.stop()
        with self.condition:
            for session in self.sessions.values():
                self.drain(session)
                session.finish()
            self.sessions.clear()

    def session(self, tracker: str) -> RecordingSession:
        """Return the running recording of a tracker; raises NotFound."""
        session = self.sessions.get(tracker)
        if session is None:
            raise NotFound(f"{tracker!r} is not being recorded; running: {sorted(self.sessions) or 'none'}")
        return session

    def drain(self, session: RecordingSession) -> list[FinishedTake]:
        """Record all samples of one tracker that wait; the caller holds `condition`."""
        finished = []
        while batch := self._queues.pop(session.tracker, BATCH_SIZE):
            finished += self._record(session, batch)
        return finished

    def process_round(self) -> bool:
        """Record one batch of each tracker in turn, so that no tracker keeps the others waiting.

        Returns:
            Whether a batch was full, so that more samples wait and the next round should begin at once. Samples that
            arrive during the round do not count: with hundreds of trackers, rounds would follow each other for one
            sample each.
        """
        with self.condition:
            sessions = list(self.sessions.values())
        now, more = self._clock(), False
        for session in sessions:
            if not self._queues.is_empty(session.tracker) or now - session.last_flush >= FLUSH_INTERVAL:
                more |= self._process(session, now) == BATCH_SIZE
            elif session.is_carrying:
                self._check_silence(session)
        return more

    def _process(self, session: RecordingSession, now: float) -> int:
        with self.condition:
            batch = self._queues.pop(session.tracker, BATCH_SIZE)
            finished = self._record(session, batch)
            if now - session.last_flush >= FLUSH_INTERVAL:
                session.flush(now)
            discard_requested = session.pop_discard_request()
            self.condition.notify_all()
        self._on_finished(finished)
        if discard_requested:
            self._on_discard_request(session)
        return len(batch)

    def _record(self, session: RecordingSession, batch: list[QueueItem]) -> list[FinishedTake]:
        if batch and batch[-1].payload is not None:
            self._presence.on_sample(session.tracker)
        if dropped := self._queues.dropped(session.tracker):
            session.counter.note(f"{dropped} samples came faster than they can be recorded, and were turned away")
        return [made for item in batch if (made := self._record_item(session, item)) is not None]

    def _record_item(self, session: RecordingSession, item: QueueItem) -> FinishedTake | None:
        payload, receive_ns = item
        try:
            if payload is None:
                return session.on_tracker_lost("the tracker has gone" + " in mid-take" * session.is_carrying)
            return session.add(decode_sample(session.tracker, payload, receive_ns), payload)
        except UnusableSample as error:
            session.counter.count_refused(str(error), error.sequence)
        except Exception as error:  # one take's fault must not end the others
            session.fail(f"recording failed: {error!r}")
        return None

    def _check_silence(self, session: RecordingSession) -> None:
        limit = self._settings.longest_silence
        if self._presence.silence_of(session.tracker) <= limit:
            return
        with self.condition:
            # A tracker whose samples wait in its queue is not silent.
            if not (self._queues.is_empty(session.tracker) and session.is_carrying):
                return
            try:
                finished = session.on_tracker_lost(f"no sample came for {limit:g} s in mid-take")
            except Exception as error:  # one take's fault must not end the others
                finished = None
                session.fail(f"recording failed: {error!r}")
        if finished is not None:
            self._on_finished([finished])
