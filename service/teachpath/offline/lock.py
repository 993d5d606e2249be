"""One service a data folder: a lock that ends with its process, however that ends."""

from __future__ import annotations

import fcntl
from pathlib import Path
from types import TracebackType

from teachpath.errors import Conflict
from teachpath.io.private_files import make_private
from teachpath.io.store.faults import storage_fault


class StationLock:
    """Holds the data folder, and keeps everybody else out of it; use it as a context manager.

    Raises:
        Conflict: another process holds it.
        UnusableSettings: others may enter it, and it is not this user's to close.
        StorageUnavailable: it cannot be written.
    """

    def __init__(self, data_dir: Path) -> None:
        self._folder = data_dir

    def __enter__(self) -> StationLock:
        try:
            make_private(self._folder)
            self._file = (self._folder / "service.lock").open("a")
        except OSError as error:
            raise storage_fault(error, self._folder) or error from None
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self._file.close()
            raise Conflict(
                f"a teachpath service is using {self._folder}; stop it first, or name another folder with --data"
            ) from None
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
