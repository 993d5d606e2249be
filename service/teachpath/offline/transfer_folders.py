"""The folders in which files come and go: uploads that wait to be imported, exports that are sent."""

from __future__ import annotations

import shutil
import uuid
from pathlib import Path


class TransferFolders:
    """Folders of files that come or go, beside the recordings, so that an import only renames its files.

    Args:
        root: their folder; made when missing.
    """

    def __init__(self, root: Path) -> None:
        self._root = root

    def make(self) -> Path:
        """Make a folder of a new name."""
        folder = self._root / uuid.uuid4().hex
        folder.mkdir(parents=True)
        return folder

    def folder(self, name: str) -> Path:
        """Return the folder of that name."""
        return self._root / name

    def remove(self, name: str) -> None:
        """Remove a folder with all that is in it."""
        shutil.rmtree(self._root / name, ignore_errors=True)
