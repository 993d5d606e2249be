"""A take that has ended and is to become a demonstration, at once or on another thread."""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from typing import Protocol

from teachpath.recorder.row_queue import RowQueue
from teachpath.recorder.take import FinishedTake, Take, TakeOutcome
from teachpath.recording.phases import TransportSpan
from teachpath.records import Demonstration, ObjectPose, StreamStatistics, Trajectory, Vector

WAITING_SENTENCE = "the recording is whole, and its row is stored as soon as that is possible"
MAX_WAITING = 16  # takes of one recording; while more wait, its samples stay in their queue, which is limited

log: logging.Logger = logging.getLogger("teachpath")


@dataclass(frozen=True, eq=False)
class ClosedTake:
    """A take to which nothing is written any more, with all that it takes to complete it.

    Attributes:
        take: its samples and its file.
        cut: its transport phase.
        statistics: of its samples.
        carried: start of the object's centre [m, world], or None.
        object_pose: of the object before it was grasped; None = where the scene has it.
        fault: why it ended too early, or empty.
        settle: called with what became of it, by whoever may change the recording.
    """

    take: Take
    cut: TransportSpan
    statistics: StreamStatistics
    carried: Vector | None
    object_pose: ObjectPose | None
    fault: str
    settle: Callable[[TakeOutcome], None]

    def finalize(self) -> TakeOutcome:
        """Make its demonstration, as `Take.finalize`."""
        return self.take.finalize(self.cut, self.statistics, self.carried, self.object_pose, self.fault)


class Completer(Protocol):
    """Completes the takes of one recording in their order."""

    @property
    def is_behind(self) -> bool:
        """Whether takes are closed faster than they are completed."""

    def complete(self, closed: ClosedTake) -> FinishedTake | None:
        """Complete a take now or later; return the demonstration that was made now."""

    def call(self, action: Callable[[], None]) -> None:
        """Call something after the takes before it are settled."""

    def wait(self) -> None:
        """Wait until all takes are settled."""


class DirectCompleter:
    """Completes takes at once, on the thread of the caller.

    Args:
        store: stores a demonstration and returns it with its number; what it raises ends the recording.
    """

    is_behind = False

    def __init__(self, store: Callable[[Demonstration], Demonstration]) -> None:
        self._store = store

    def complete(self, closed: ClosedTake) -> FinishedTake | None:
        """Complete a take now."""
        outcome = closed.finalize()
        if outcome.finished is not None:
            demonstration, trajectory = outcome.finished
            outcome = TakeOutcome((self._store(demonstration), trajectory))
        closed.settle(outcome)
        return outcome.finished

    def call(self, action: Callable[[], None]) -> None:
        """Call something now."""
        action()

    def wait(self) -> None:
        """Do nothing: all takes are settled."""


class TakeQueue:
    """Completes the takes of one recording in their order, on threads of a pool, while it goes on recording.

    Args:
        pool: may be shared with other recordings; a long take keeps one of its threads busy.
        condition: held while a take is settled, and notified when all are.
        on_finished: called with each demonstration that is stored, on a thread of the pool, or of the rows.
        rows: stores their rows.
    """

    def __init__(
        self,
        pool: Executor,
        condition: threading.Condition,
        on_finished: Callable[[FinishedTake], None],
        rows: RowQueue,
    ) -> None:
        self._pool = pool
        self._condition = condition
        self._on_finished = on_finished
        self._rows = rows
        self._actions: deque[Callable[[], None]] = deque()
        self._is_running = False

    @property
    def is_behind(self) -> bool:
        """Whether takes are closed faster than they are completed."""
        return len(self._actions) > MAX_WAITING

    @property
    def is_running(self) -> bool:
        """Whether takes are not settled yet; to be asked while the condition is held."""
        return self._is_running

    def complete(self, closed: ClosedTake) -> FinishedTake | None:
        """Complete a take after those before it."""
        closed.take.flush()  # a killed process loses nothing of a take that waits
        self.call(partial(self._complete, closed))
        return None

    def call(self, action: Callable[[], None]) -> None:
        """Call something after the takes before it are settled."""
        with self._condition:
            self._actions.append(action)
            if not self._is_running:
                self._is_running = True
                self._pool.submit(self._run)

    def wait(self) -> None:
        """Wait until all takes are settled; the caller may hold the condition."""
        with self._condition:
            self._condition.wait_for(lambda: not self._is_running)

    def _run(self) -> None:
        while True:
            with self._condition:
                if not self._actions:
                    self._is_running = False
                    self._condition.notify_all()
                    return
                action = self._actions.popleft()
            try:
                action()
            except Exception:  # what one take does must not keep the others from their end
                log.exception("what follows a take failed")

    def _complete(self, closed: ClosedTake) -> None:
        try:
            outcome = closed.finalize()
            if outcome.finished is not None:
                demonstration, trajectory = outcome.finished
                reason = self._rows.add(demonstration, partial(self._settle_stored, closed, trajectory))
                if not reason:
                    return
                note = f"{WAITING_SENTENCE}: {reason}"
                outcome = TakeOutcome(None, (note,), row_waits=True)
        except Exception as error:  # one take's fault must not end the others
            outcome = closed.take.lose(f"recording failed: {error!r}")
        with self._condition:
            closed.settle(outcome)

    def _settle_stored(self, closed: ClosedTake, trajectory: Trajectory, stored: Demonstration) -> None:
        with self._condition:
            closed.settle(TakeOutcome((stored, trajectory)))
        self._on_finished((stored, trajectory))
