"""Where imports of several files wait until all are taken over, and what of them was abandoned."""

from __future__ import annotations

import fcntl
import time
import uuid
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TextIO

from teachpath.errors import Conflict, TeachpathError
from teachpath.io.documents import decode, encode
from teachpath.io.private_files import write_private

STAGING: Final = "imports"  # in the folder of the data
SESSION: Final = "session.json"  # in a staging folder: what is imported
LOCK: Final = "lock"
LOCK_TIMEOUT: Final = 1.0  # [s] for which somebody else may look at a staging folder
MAX_NAMED: Final = 5  # files that a sentence names


@dataclass(frozen=True, slots=True)
class ImportSession:
    """An import of files.

    Attributes:
        id: from which the ids of its demonstrations follow, also when it goes on after it was killed.
        task: that they are imported into.
        files: their names.
    """

    id: str
    task: str
    files: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class AbandonedImport:
    """An import that was killed and did not go on.

    Attributes:
        folder: of what is kept of it.
        summary: file that is there when all of it was stored.
        session: what was imported; None: it was killed before it began.
    """

    folder: Path
    summary: Path
    session: ImportSession | None

    @property
    def is_stored(self) -> bool:
        """Whether its demonstrations are stored, so that nothing is lost with the folder."""
        return self.summary.exists()

    @property
    def fault(self) -> str:
        """What happened, as a clause."""
        if self.session is None:
            return "an import was cut off as it began"
        names, more = self.session.files[:MAX_NAMED], len(self.session.files) - MAX_NAMED
        shown = ", ".join(names) + (f" and {more} more" if more > 0 else "")
        kept = "all of it is stored" if self.is_stored else "nothing of it is stored"
        return f"the import of {shown} into {self.session.task} was cut off, {kept}"


def begin_session(folder: Path, task: str, files: Sequence[str]) -> ImportSession:
    """Return the session of a staging folder; a new one is written where there is none."""
    file = folder / SESSION
    if not file.exists():
        write_private(file, encode(ImportSession(uuid.uuid4().hex, task, tuple(files))).decode())
    return decode(ImportSession, file.read_bytes())


@contextmanager
def locked_staging(folder: Path) -> Iterator[None]:
    """Keep others out of a staging folder.

    Raises:
        Conflict: the same import is under way elsewhere.
    """
    deadline = time.monotonic() + LOCK_TIMEOUT
    with (folder / LOCK).open("a") as file:
        while not _lock(file, fcntl.LOCK_EX):
            if time.monotonic() > deadline:
                raise Conflict("the same files are being imported by another process; wait for it")
            time.sleep(LOCK_TIMEOUT / 20)
        yield


def abandoned_imports(data_dir: Path) -> list[AbandonedImport]:
    """List the imports of files that were killed and that nobody goes on with now."""
    root = data_dir / STAGING
    folders = {entry.with_suffix("") for entry in root.glob("*") if entry.is_dir() or entry.suffix == ".json"}
    return [
        AbandonedImport(folder, folder.with_suffix(".json"), _session(folder))
        for folder in sorted(folders)
        if not _is_under_way(folder)
    ]


def abandoned_notes(data_dir: Path) -> list[str]:
    """Say of abandoned imports while the service runs."""
    return [f"{each.fault}; stop the service and run: teachpath doctor" for each in abandoned_imports(data_dir)]


def _session(folder: Path) -> ImportSession | None:
    try:
        return decode(ImportSession, (folder / SESSION).read_bytes())
    except (OSError, TeachpathError):
        return None


def _is_under_way(folder: Path) -> bool:
    try:
        with (folder / LOCK).open() as file:
            return not _lock(file, fcntl.LOCK_SH)
    except OSError:  # it is gone, or nobody has locked it yet
        return False


def _lock(file: TextIO, how: int) -> bool:
    try:
        fcntl.flock(file, how | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
