"""Rows of finished recordings that the database has not taken yet, each in a file beside its recording.

A finished recording says all that is in its row, too, so that the doctor can make it; these files say which rows the
recorder stores by itself, also after a restart.
"""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Final

from teachpath.errors import UnusableInput
from teachpath.io import documents
from teachpath.io.private_files import write_private
from teachpath.records import Demonstration

ENDING: Final = ".row"  # after the name of the recording

log: logging.Logger = logging.getLogger("teachpath")


class KeptRows:
    """What lies in the folder of recordings for the database.

    Args:
        root: the folder.
    """

    def __init__(self, root: Path) -> None:
        self._root = root

    def keep(self, demonstration: Demonstration) -> None:
        """Keep a row until `forget`; raises OSError."""
        write_private(self._file(demonstration.recording), documents.encode(demonstration).decode())

    def forget(self, demonstration: Demonstration) -> None:
        """Forget a row, which is stored; raises OSError."""
        self._file(demonstration.recording).unlink(missing_ok=True)

    def places(self) -> set[str]:
        """Return the places of the recordings whose rows are kept."""
        return {file.relative_to(self._root).as_posix().removesuffix(ENDING) for file in self._files()}

    def read(self) -> list[Demonstration]:
        """Return what was kept, oldest first; rows that cannot be read, or have no recording, are left out."""
        found = []
        for file in self._files():
            try:
                kept = documents.decode_demonstration(file.read_bytes())
            except (OSError, UnusableInput) as error:
                log.error("the row in %s cannot be read, and is the doctor's: %s", file, error)
                continue
            if (self._root / kept.recording).is_file():
                found.append(kept)
        return sorted(found, key=lambda kept: kept.created_ns)

    def _files(self) -> list[Path]:
        return sorted(self._root.glob(f"*/*.mcap{ENDING}"))

    def _file(self, place: str) -> Path:
        return self._root / f"{place}{ENDING}"
