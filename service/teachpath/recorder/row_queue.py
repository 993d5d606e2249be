"""The rows of takes on their way to the database, which may be away for a while."""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Final

from teachpath.errors import Conflict, NotFound, StorageUnavailable, TeachpathError
from teachpath.io.store.store import Store
from teachpath.periodic_thread import PeriodicThread
from teachpath.records import Demonstration

INTERVAL: Final = 0.5  # [s] between two attempts

log: logging.Logger = logging.getLogger("teachpath")

OnStored = Callable[[Demonstration], None]


@dataclass
class _WaitingRow:
    demonstration: Demonstration
    on_stored: OnStored


class RowQueue:
    """Stores the rows of whole takes at once, and those that the database does not take as soon as it does.

    They keep their order. Each that waits is kept in a file, too: the next service stores it where this one ends first.
    Safe to use from several threads.
    """

    def __init__(self, store: Store) -> None:
        self._store = store
        self._kept = store.recordings.kept_rows
        self._waiting: deque[_WaitingRow] = deque()
        self._storing = threading.Lock()  # held by whoever takes rows out, or changes one
        self._fault = "the database was not asked yet"
        self._thread = PeriodicThread("rows of takes", INTERVAL, self.store_waiting)

    def start(self) -> None:
        """Store what an earlier service has kept, and from now on what waits."""
        self._waiting.extend(_WaitingRow(row, lambda stored: None) for row in self._kept.read())
        self.store_waiting()
        self._thread.start()

    def stop(self) -> None:
        """Try no more; what still waits is stored by the next service."""
        self._thread.stop()
        if self._waiting:
            log.warning("the rows of %d takes wait for the next start: %s", len(self._waiting), self._fault)

    def add(self, demonstration: Demonstration, on_stored: OnStored) -> str:
        """Store a row now or later, and call `on_stored` with it then; return why it waits, or nothing.

        Raises:
            TeachpathError: the database refuses it for good.
        """
        if self._waiting:
            fault = self._fault
        else:
            try:
                stored = self._store.add_demonstration(demonstration)
            except StorageUnavailable as error:
                fault = self._fault = str(error)
            else:
                on_stored(stored)
                return ""
        self._keep(demonstration)
        self._waiting.append(_WaitingRow(demonstration, on_stored))
        return fault

    def store_waiting(self) -> None:
        """Store the rows that wait, as far as the database takes them."""
        with self._storing:
            while self._waiting:
                waiting, stored = self._waiting[0], None
                row = waiting.demonstration
                try:
                    stored = self._stored(row)
                except (StorageUnavailable, Conflict) as error:
                    self._fault = str(error)
                    return
                except TeachpathError as error:
                    reason = f"take {row.id} of {row.task} by {row.source} is whole, and has no row: {error}"
                    self._store.health.note_lost(f"{reason}; stop the service and run: teachpath doctor")
                with suppress(OSError):  # the next start finds its row stored
                    self._kept.forget(row)
                if stored is not None:
                    waiting.on_stored(stored)
                self._waiting.popleft()  # last: a new row of the same recording comes behind it

    def discard_newest(self, tracker: str) -> bool:
        """Discard the newest take of a tracker whose row waits; return whether there was one."""
        with self._storing:
            for waiting in reversed(self._waiting):
                row = waiting.demonstration
                if row.source == tracker and not row.discarded_ns:
                    waiting.demonstration = replace(row, discarded_ns=time.time_ns())
                    self._keep(waiting.demonstration)
                    return True
        return False

    def require_stored(self, task: str) -> None:
        """Raise Conflict while rows of a task wait."""
        self.store_waiting()
        if any(waiting.demonstration.task == task for waiting in list(self._waiting)):
            raise Conflict(f"takes of task {task} wait for their rows: {self._fault}")

    def faults(self) -> list[str]:
        """Say how many rows wait, and why."""
        if not (count := len(self._waiting)):
            return []
        return [f"{count} takes are whole, and their rows are stored by themselves when they can be: {self._fault}"]

    def _stored(self, row: Demonstration) -> Demonstration:
        self._store.task(row.task)  # it may have been removed meanwhile
        with suppress(NotFound):  # the row may have been stored, and the line cut before that was said
            return self._store.demonstration(row.id)
        return self._store.add_demonstration(row)

    def _keep(self, row: Demonstration) -> None:
        try:
            self._kept.keep(row)
        except OSError as error:
            log.warning("the row of %s waits in memory alone, and after a crash for the doctor: %s", row.id, error)
