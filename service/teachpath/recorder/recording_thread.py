"""The thread that records the samples that were received, one tracker after the other."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from weakref import WeakSet

from teachpath.errors import Conflict, NotFound
from teachpath.periodic_thread import PeriodicThread
from teachpath.recorder.batch_recorder import BatchRecorder
from teachpath.recorder.closed_take import TakeQueue
from teachpath.recorder.presence import Presence
from teachpath.recorder.row_queue import RowQueue
from teachpath.recorder.sample_queues import SampleQueues
from teachpath.recorder.suspendable_session import SuspendableSession
from teachpath.recorder.take import FinishedTake
from teachpath.recording.settings import RecordingSettings
from teachpath.records import SuspendedRecording

FLUSH_INTERVAL = 0.75  # [s] under a second, with a margin for a busy machine
ROUND_INTERVAL = 0.02  # [s] pause between two rounds; none while more samples wait than one round records
COMPLETING_THREADS = 3  # takes that are completed at once; a long one keeps the others of its tracker waiting alone
BATCH_SIZE = 200  # samples of one tracker that are recorded before the turn of the next
# Recordings that have their turn in one round. With hundreds, several samples of each wait then, and what is known of
# one is read into the processor's cache once for them all.
TURNS_IN_A_ROUND = 100


class RecordingThread:
    """Holds the running recordings, one a tracker, and writes into them the samples that wait in the queues.

    Args:
        on_finished: called with new demonstrations, on a thread that completes takes.
        on_discard_request: called, on such a thread, with a recording whose hand commands to discard its last
            demonstration.
        rows: stores the rows of takes.
        clock: [s] monotonic.

    Attributes:
        sessions: the running recordings by tracker; used only while `condition` is held.
        condition: notified whenever samples have been recorded.
        beginning: held while a recording begins.
    """

    def __init__(
        self,
        queues: SampleQueues,
        presence: Presence,
        settings: RecordingSettings,
        *,
        on_finished: Callable[[FinishedTake], None],
        on_discard_request: Callable[[SuspendableSession], None],
        rows: RowQueue,
        clock: Callable[[], float],
    ) -> None:
        self._queues = queues
        self._presence = presence
        self._settings = settings
        self._on_finished = on_finished
        self._on_discard_request = on_discard_request
        self._rows = rows
        self._clock = clock
        self.sessions: dict[str, SuspendableSession] = {}
        self.condition: threading.Condition = threading.Condition()
        self.beginning: threading.Lock = threading.Lock()
        self._completing = ThreadPoolExecutor(COMPLETING_THREADS, thread_name_prefix="takes")
        self._take_queues: WeakSet[TakeQueue] = WeakSet()  # of ended recordings too, while their takes are completed
        self._batches = BatchRecorder(queues, presence, settings)  # used only while `condition` is held
        self._next_turn = 0  # of the running recordings, whose turn it is in the next round
        self._thread = PeriodicThread("recorder", ROUND_INTERVAL, self.process_round)

    def start(self) -> None:
        """Record from now on."""
        self._thread.start()

    def stop(self) -> list[SuspendedRecording]:
        """Record the samples that still wait, leave every recording for the next start, and stop; return them.

        A second call does nothing.
        """
        self._thread.stop()
        with self.condition:
            sessions = list(self.sessions.values())
            for session in sessions:
                if not session.is_waiting:
                    self.drain(session)
                session.suspend()
            self.sessions.clear()
        for session in sessions:
            session.completer.wait()
        self._completing.shutdown()
        return [session.snapshot() for session in sessions]

    def session(self, tracker: str) -> SuspendableSession:
        """Return the running recording of a tracker; raises NotFound."""
        session = self.sessions.get(tracker)
        if session is None:
            raise NotFound(f"{tracker!r} is not being recorded; running: {sorted(self.sessions) or 'none'}")
        return session

    def take_queue(self) -> TakeQueue:
        """Return what completes the takes of one recording, beside those of the others."""
        queue = TakeQueue(self._completing, self.condition, self._on_finished, self._rows)
        self._take_queues.add(queue)
        return queue

    def is_writing(self) -> bool:
        """Tell whether a recording runs, or a take that has ended is being completed."""
        with self.condition:
            return bool(self.sessions) or any(queue.is_running for queue in list(self._take_queues))

    def wait_for_takes(self) -> None:
        """Wait until the takes that have ended are stored; the rows of some may still wait for the database."""
        with self.condition:
            sessions = list(self.sessions.values())
        for session in sessions:
            session.completer.wait()
        self._rows.store_waiting()

    @contextmanager
    def kept_idle(self, task: str) -> Iterator[None]:
        """Let no recording of a task begin in the block, and all takes be stored; raises Conflict where not."""
        with self.beginning:
            with self.condition:
                running = sorted(tracker for tracker, session in self.sessions.items() if session.task == task)
            if running:
                raise Conflict(f"task {task} is being recorded from {', '.join(running)}; stop that first")
            for queue in list(self._take_queues):
                queue.wait()
            self._rows.require_stored(task)
            yield

    def drain(self, session: SuspendableSession) -> None:
        """Record all samples of one tracker that wait; the caller holds `condition`."""
        while batch := self._queues.pop(session.tracker, BATCH_SIZE):
            self._batches.record([(session, batch)])

    def process_round(self) -> bool:
        """Record one batch of each tracker in turn, so that no tracker keeps the others waiting.

        Of more than `TURNS_IN_A_ROUND` trackers the next ones have their turn.

        Returns:
            Whether a batch was full, so that more samples wait and the next round should begin at once. Samples that
            arrive during the round do not count: with hundreds of trackers, rounds would follow each other for one
            sample each.
        """
        with self.condition:
            sessions = list(self.sessions.values())
        turns = deque(self._choose(sessions))
        now, more = self._clock(), False
        while turns:
            more |= self._process(turns, now)
        return more

    def _choose(self, sessions: list[SuspendableSession]) -> list[SuspendableSession]:
        begin = self._next_turn if self._next_turn < len(sessions) else 0
        self._next_turn = begin + TURNS_IN_A_ROUND
        return sessions[begin : self._next_turn]

    def _process(self, turns: deque[SuspendableSession], now: float) -> bool:
        """Record the samples of the next trackers, together as many as a batch; return whether one's batch was full."""
        due, batches, count, full = [], [], 0, False
        with self.condition:
            while turns and count < BATCH_SIZE:
                session = turns.popleft()
                # One that has ended is left: what waits is of the next recording.
                if not self._takes_turn(session) or self.sessions.get(session.tracker) is not session:
                    continue
                batch = self._queues.pop(session.tracker, BATCH_SIZE)
                count += len(batch)
                full |= len(batch) == BATCH_SIZE
                if batch or now - session.last_flush >= FLUSH_INTERVAL:
                    due.append(session)
                    batches.append((session, batch))
                elif session.is_carrying:
                    self._check_silence(session)
            self._batches.record(batches)
            for session in due:
                if now - session.last_flush >= FLUSH_INTERVAL:
                    session.flush(now)
                if session.pop_discard_request():
                    session.completer.call(partial(self._on_discard_request, session))
            if due:
                self.condition.notify_all()
        return full

    @staticmethod
    def _takes_turn(session: SuspendableSession) -> bool:
        return not (session.completer.is_behind or session.is_waiting)

    def _check_silence(self, session: SuspendableSession) -> None:
        limit = self._settings.longest_silence
        if self._presence.silence_of(session.tracker) <= limit:
            return
        if not self._queues.is_empty(session.tracker):  # it is not silent: its samples wait
            return
        try:
            session.on_tracker_lost(f"no sample came for {limit:g} s in mid-take")
        except Exception as error:  # one take's fault must not end the others
            session.fail(f"recording failed: {error!r}")
