"""What the services of a station share of its jobs: what one leaves another does, and each can cancel all."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from teachpath.periodic_thread import PeriodicThread
from teachpath.records import Job

if TYPE_CHECKING:  # the settings of jobs are read in processes that have no store
    from teachpath.io.store.store import Store

ALIVE_INTERVAL: Final = 2.0  # [s] between two signs of life


@dataclass(frozen=True)
class OwnJobs:
    """What a service does with its own jobs.

    Attributes:
        kinds: names of the kinds that it can do.
        running: returns the ids of those that it does now.
        break_off: ends one of them.
        found: called with a job that nobody does, as often as it is found.
        changed: called with the id of a job that another service has changed.
        forget_ended: called when changes may have passed unheard.
    """

    kinds: Sequence[str]
    running: Callable[[], list[str]]
    break_off: Callable[[str], object]
    found: Callable[[Job], None]
    changed: Callable[[str], None]
    forget_ended: Callable[[], None]


class SharedJobs:
    """Looks after jobs on a database that several services share, at an interval and when another service says so."""

    def __init__(self, store: Store, own: OwnJobs) -> None:
        self._store, self._own = store, own
        self._thread = PeriodicThread("shared jobs", ALIVE_INTERVAL, self._look)

    def start(self) -> None:
        """Look from now on; where no other service can be, never."""
        if self._store.services.is_shared:
            self._store.feed.start(self._hear)
            self._thread.start()

    def stop(self) -> None:
        """Stop looking; a second call does nothing."""
        self._store.feed.stop()
        self._thread.stop()

    def _look(self) -> None:
        self._store.services.note_alive()
        self._break_off()
        for job in self._store.claims.waiting(self._own.kinds):
            self._own.found(job)

    def _hear(self, table: str, key: str) -> None:
        if table == "jobs":
            self._break_off()
            self._own.changed(key)
        elif not key:
            self._own.forget_ended()
            self._look()

    def _break_off(self) -> None:
        for key in self._store.claims.to_break_off(self._own.running()):
            self._own.break_off(key)
