"""Standing by: a service that waits until the one that is the station's has ended, and then takes its place."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Final

from teachpath.errors import Conflict, StorageUnavailable
from teachpath.io.store.database_files import database_url
from teachpath.io.store.engine import unmigrated_engine
from teachpath.io.store.services import find_holder
from teachpath.io.store.settings import StoreSettings
from teachpath.offline.lock import StationLock

LOOK_INTERVAL: Final = 0.5  # [s]


def await_turn(store: StoreSettings, stop: threading.Event, say: Callable[[str], object]) -> bool:
    """Wait until no service is the station's any more: it has ended, or gave no sign of life for too long.

    Nothing is written meanwhile, and the tables stay as the other service knows them. When this returns, another one
    that waited may be faster.

    Args:
        store: of the station, by its data folder and, on PostgreSQL, by its name.
        stop: set when there is no use in waiting any more.
        say: called with what is waited for, whenever that is something new.

    Returns:
        Whether it is this one's turn; False: `stop` was set.

    Raises:
        UnusableSettings: see `StationLock` and `open_engine`.
    """
    said, engine = "", unmigrated_engine(database_url(store))
    try:
        while not stop.is_set():
            try:
                with StationLock(Path(store.data_dir)):  # let go at once: the former service may be started anew
                    pass
                awaited = find_holder(engine, store.station, Path(store.data_dir))
            except (Conflict, StorageUnavailable) as error:
                awaited = str(error)
            if not awaited:
                return True
            if awaited != said:
                said = awaited
                say(awaited)
            stop.wait(LOOK_INTERVAL)
        return False
    finally:
        engine.dispose()
