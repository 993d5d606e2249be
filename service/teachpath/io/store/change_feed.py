"""Rows that other services on the same database have changed: PostgreSQL notifies of each when its transaction ends."""

from __future__ import annotations

import logging
import threading
from typing import Any, Final

from sqlalchemy import Engine

from teachpath.errors import TeachpathError
from teachpath.io.store.changes import ALL_TOPICS, CHANNEL, Changed
from teachpath.io.store.engine import is_served

log: logging.Logger = logging.getLogger("teachpath")

LINE_CHECK: Final = 0.5  # [s] without a notification after which the line is tried
RECONNECT_INTERVAL: Final = 0.5  # [s]


class ChangeFeed:
    """Hears of rows that others have changed, on a thread of its own; on SQLite there is nobody else.

    After the line was lost it tells once that everything may have changed (`EVERYTHING`), for nobody keeps what was
    notified meanwhile.

    Args:
        service: whose own changes it passes over.
        changed: called with table and key of a row.
    """

    def __init__(self, engine: Engine, service: str, changed: Changed) -> None:
        self._engine, self._service, self._changed = engine, service, changed
        self._also: Changed = lambda table, key: None
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self, also: Changed) -> None:
        """Listen from now on; `also` hears of every change behind `changed`."""
        if is_served(self._engine):
            self._also = also
            self._thread = threading.Thread(target=self._run, name="change feed", daemon=True)
            self._thread.start()

    def stop(self) -> None:
        """Stop listening; a second call does nothing."""
        self._stopping.set()
        thread, self._thread = self._thread, None
        if thread is not None:
            thread.join()

    def _run(self) -> None:
        reason = ""
        while not self._stopping.is_set():
            try:
                self._listen(lost=bool(reason))
            except Exception as error:  # whatever the driver raises: the line is made anew
                if not reason:
                    log.warning("the line on which the database notifies is lost, and made anew: %s", error)
                reason = str(error) or type(error).__name__
                self._stopping.wait(RECONNECT_INTERVAL)

    def _listen(self, *, lost: bool) -> None:
        with self._engine.connect() as connection:
            driver: Any = connection.connection.driver_connection
            try:
                driver.autocommit = True
                driver.execute(f"LISTEN {CHANNEL}")
                if lost:
                    self._tell(ALL_TOPICS, "")
                while not self._stopping.is_set():
                    for note in driver.notifies(timeout=LINE_CHECK, stop_after=1):
                        self._hear(note.payload)
                    driver.execute("SELECT 1")  # raises where the line is lost
            finally:
                connection.invalidate()  # nobody else is to get a connection that listens

    def _hear(self, payload: str) -> None:
        service, table, key = payload.split(" ", 2)
        if service != self._service:
            self._tell(table, key)

    def _tell(self, table: str, key: str) -> None:
        for hear in (self._changed, self._also):
            try:
                hear(table, key)
            except TeachpathError as error:  # the row cannot be read now: the next look finds it
                log.warning("a change of %s %s was not followed: %s", table, key, error)
