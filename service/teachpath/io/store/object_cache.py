"""Copies of the objects that were read last, so that what is shown or learned again is not fetched again."""

from __future__ import annotations

import os
import time
import uuid
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import Final

from teachpath.io.store.faults import TEMPORARY, storage_fault
from teachpath.io.store.object_storage import ObjectStorage

CACHE: Final = "cache"  # their folder, in that of the data
CACHE_SIZE: Final = 2 << 30  # bytes


class ObjectCache:
    """The folder of the copies; several processes may use one. An object never changes, so no copy is out of date.

    Args:
        folder: of the copies; made when missing.
        limit: bytes that they may take; the newest copy is kept even so.
        objects: of which they are.
    """

    def __init__(self, folder: Path, limit: int, objects: ObjectStorage) -> None:
        self._folder, self._limit, self._objects = folder, limit, objects

    def file(self, address: str) -> Path:
        """Return a copy of an object, fetched where there is none.

        Raises:
            NotFound: there is no such object.
            StorageUnavailable: the object storage does not answer, or the copy cannot be written.
        """
        file = self._file(address)
        with suppress(FileNotFoundError):
            _note_use(file)
            return file
        content = self._objects.read(address)
        temporary = self._folder / f"{uuid.uuid4().hex}{TEMPORARY}"
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            temporary.write_bytes(content)
            _note_use(temporary)
            temporary.rename(file)
        except OSError as error:
            temporary.unlink(missing_ok=True)
            raise storage_fault(error, temporary) or error from None
        self._shrink(file)
        return file

    def drop(self, address: str) -> None:
        """Remove the copy of an object."""
        self._file(address).unlink(missing_ok=True)

    def _file(self, address: str) -> Path:
        return self._folder / f"{sha256(address.encode()).hexdigest()[:32]}.mcap"

    def _shrink(self, kept: Path) -> None:
        """Remove the copies that were used longest ago, until the others keep the limit."""
        known = []
        for file in self._folder.glob("*.mcap"):
            with suppress(FileNotFoundError):  # another process removed it
                known.append((file.stat().st_mtime_ns, file.stat().st_size, file))
        total = sum(size for _, size, _ in known)
        for _, size, file in sorted(known):
            if total <= self._limit:
                return
            if file != kept:
                file.unlink(missing_ok=True)
                total -= size


def _note_use(file: Path) -> None:
    """Let a copy be the last of those that are removed; raises FileNotFoundError where there is none."""
    now = time.time_ns()  # finer than the file system's own clock
    os.utime(file, ns=(now, now))
