"""The folders in which files come and go: uploads that wait to be imported, exports that are sent."""

from __future__ import annotations

import shutil
import time
import uuid
from collections.abc import Collection
from pathlib import Path


class TransferFolders:
    """Folders of files that come or go, beside the recordings, so that an import only renames its files.

    Args:
        root: their folder; made when missing.
    """

    def __init__(self, root: Path) -> None:
        self._root = root
        self._owners: dict[str, str] = {}  # by the name of the folder

    def make(self, owner: str = "") -> Path:
        """Make a folder of a new name, for somebody."""
        folder = self._root / uuid.uuid4().hex
        folder.mkdir(parents=True)
        self._owners[folder.name] = owner
        return folder

    def size_of(self, owner: str) -> int:
        """Return how many bytes are in the folders of somebody."""
        own = [name for name, each in tuple(self._owners.items()) if each == owner]
        return sum(_size(file) for name in own for file in self.folder(name).glob("*"))

    def folder(self, name: str) -> Path:
        """Return the folder of that name."""
        return self._root / name

    def remove(self, name: str) -> None:
        """Remove a folder with all that is in it."""
        shutil.rmtree(self._root / name, ignore_errors=True)
        self._owners.pop(name, None)

    def names(self) -> list[str]:
        """Return the names of all folders."""
        return [folder.name for folder in self._root.glob("*")]

    def remove_forgotten(self, kept: Collection[str], lifetime: float) -> None:
        """Remove the folders that are older than `lifetime` [s], but for those in `kept`."""
        now = time.time()
        for folder in self._root.glob("*"):
            if folder.name not in kept and now - folder.stat().st_mtime > lifetime:
                self.remove(folder.name)


def _size(file: Path) -> int:
    try:
        return file.stat().st_size
    except OSError:  # it was imported or removed meanwhile
        return 0
