"""Whether the data folder and the database can be written now, and which takes they could not keep."""

from __future__ import annotations

import sqlite3
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Final

from sqlalchemy import Engine
from sqlalchemy.exc import DBAPIError

from teachpath.errors import TeachpathError
from teachpath.io.store.faults import TEMPORARY, database_fault, storage_fault

INTERVAL: Final = 1.0  # [s] between two looks
LOCK_GRACE: Final = 3.0  # [s] for which others may write before the database counts as locked
PROBE_SIZE: Final = 64 * 1024  # bytes that must be free
MAX_TAKES: Final = 20  # that are named


class StorageHealth:
    """Looks at a store's folder and database, at most once a second.

    Args:
        folder: of the recordings; made when missing.
        engine: of the database.
        file: of the database; None: it has a server, or is in memory.
        clock: [s] monotonic.
    """

    def __init__(
        self, folder: Path, engine: Engine, file: Path | None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._folder, self._engine, self._file, self._clock = folder, engine, file, clock
        self._lock = threading.Lock()
        self._looked, self._locked_since = float("-inf"), float("inf")
        self._faults: list[str] = []
        self._lost: deque[str] = deque(maxlen=MAX_TAKES)

    def note_lost(self, sentence: str) -> None:
        """Note a take that could not be kept; it is said until the service ends."""
        self._lost.append(sentence)

    def faults(self) -> list[str]:
        """Say what cannot be written now, and which takes could not be kept."""
        with self._lock:
            if (now := self._clock()) - self._looked >= INTERVAL:
                self._looked = now
                self._faults = [fault for fault in (self._folder_fault(), self._database_fault(now)) if fault]
            return [*self._faults, *self._lost]

    def _folder_fault(self) -> str:
        probe = self._folder / f"probe{TEMPORARY}"
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            probe.write_bytes(bytes(PROBE_SIZE))
            probe.unlink()
        except OSError as error:
            return f"no take can be kept: {storage_fault(error, self._folder) or error}"
        return ""

    def _database_fault(self, now: float) -> str:
        try:
            if self._file is None:
                with self._engine.connect():
                    return ""
            with closing(sqlite3.connect(f"{self._file.absolute().as_uri()}?mode=rw", uri=True, timeout=0.0)) as probe:
                probe.execute("BEGIN IMMEDIATE")
        except sqlite3.Error as error:
            if error.sqlite_errorname.startswith(("SQLITE_BUSY", "SQLITE_LOCKED")):
                self._locked_since = min(self._locked_since, now)
                if now - self._locked_since < LOCK_GRACE:
                    return ""
            return str(database_fault(error, str(self._file)) or error)
        except (TeachpathError, DBAPIError) as error:
            return str(error)
        self._locked_since = float("inf")
        return ""
