"""A backup of a data folder, taken while the service runs, and its way back.

The database is copied as it stands between two transactions; a recording is whole before its row is stored and never
changes after, so all that the copy names is there. Everything is a file of its own with its SHA-256 in a manifest.
"""

from __future__ import annotations

import json
import os
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any, Final

from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.io.store.database_files import DATABASE, copy_database, database_file
from teachpath.io.store.faults import TEMPORARY, storage_fault
from teachpath.io.store.object_storage import is_address
from teachpath.io.store.recordings import RECORDINGS, Recordings
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.leftovers import TRANSFERS
from teachpath.offline.lock import StationLock

MANIFEST: Final = "manifest.json"
EXECUTIONS: Final = "executions"
FILE_FOLDERS: Final = (RECORDINGS, EXECUTIONS, TRANSFERS)
REPLACED_FOLDER: Final = "aside"
Progress = Callable[[float, str], None]


@dataclass(frozen=True, slots=True)
class Backup:
    """What a backup holds.

    Attributes:
        files: their count, the database among them.
        size: of all [bytes].
        faults: recordings that are missing or not what was recorded, which a backup cannot mend.
        distant: recordings that stay in object storage, which keeps copies in its own way.
    """

    files: int
    size: int
    faults: tuple[str, ...] = ()
    distant: int = 0


def back_up(settings: StoreSettings, into: Path, progress: Progress = lambda fraction, what: None) -> Backup:
    """Copy a station's data into a new folder, all or nothing; the service may run.

    Raises:
        Conflict: there is something at `into` already.
        NotFound: there is no database.
        UnusableInput: its database has a server.
        StorageUnavailable: something cannot be read or written.
    """
    file = database_file(settings)
    if file is None:
        raise UnusableInput("the database has a server: copy it to a folder (teachpath store copy), and back that up")
    if not file.is_file():
        raise NotFound(f"there is no database at {file}; name the data folder with --data")
    if into.exists():
        raise Conflict(f"{into} is there already; name a new folder")
    part = into.with_name(f".{into.name}{TEMPORARY}")
    with _removed_unless_whole(part):
        part.mkdir(parents=True, mode=0o700)  # hashes of passwords are in the database
        copy_database(file, part / DATABASE)
        found = _copy_files(settings, part, progress)
        _sync(part)
        part.rename(into)
    return found


def restore(source: Path, settings: StoreSettings, *, replace: bool = False) -> Path | None:
    """Bring a backup back into a data folder, after every file of it was compared with its SHA-256.

    Args:
        source: folder of the backup.
        settings: of the data folder.
        replace: set aside what is in the data folder; if False, only an empty one is restored to.

    Returns:
        The folder in which the former data are now, or None where there were none.

    Raises:
        Conflict: the service is running, or there are data and `replace` is not set.
        UnusableInput: the backup is not whole, or the database has a server.
    """
    if database_file(settings) is None:
        raise UnusableInput("the database has a server: restore to a folder, then copy it there (teachpath store copy)")
    listed = _verified(source)
    data = Path(settings.data_dir)
    with StationLock(data):
        former = [data / name for name in (*FILE_FOLDERS, *_databases(data)) if (data / name).exists()]
        if former and not replace:
            raise Conflict(
                f"{data} holds data already ({', '.join(path.name for path in former)}); name another folder with "
                "--data, or set them aside with --replace"
            )
        part = data / f"restore{TEMPORARY}"
        with _removed_unless_whole(part):
            for name in listed:
                (part / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source / name, part / name)
            _sync(part)
            aside = _set_aside(former, data) if former else None
            for name in (
                *FILE_FOLDERS,
                DATABASE,
            ):  # the database last: without it a service reads nothing
                if (part / name).exists():
                    (part / name).rename(data / name)
            part.rmdir()
    Store(settings).close()  # brings the tables of an older teachpath up to date
    return aside


def _copy_files(settings: StoreSettings, part: Path, progress: Progress) -> Backup:
    """Copy all that the copied database names, and the recordings of executions; write the manifest."""
    data = Path(settings.data_dir)
    recordings = Recordings(data / RECORDINGS, url=settings.recordings, cache_size=settings.cache_size)
    copy = Store(StoreSettings(data_dir=str(part), database=f"sqlite:///{part / DATABASE}"))
    try:
        rows = [row for _, row in copy.checks.demonstrations() if not isinstance(row, str)]
        uploads = copy.awaited_uploads()
    finally:
        copy.close()
    digests = {f"{RECORDINGS}/{row.recording}": row.digest for row in rows if not is_address(row.recording)}
    distant = len(rows) - len(digests)
    names = [*digests, *(f"{EXECUTIONS}/{file.name}" for file in sorted((data / EXECUTIONS).glob("*.mcap")))]
    names += [f"{TRANSFERS}/{upload}/upload" for upload in uploads]
    listed: dict[str, dict[str, Any]] = {}
    faults = []
    for number, name in enumerate(names):
        progress(number / len(names), name)
        try:
            # One that the copied database has in the folder may have been uploaded since.
            source = recordings.path(name.removeprefix(f"{RECORDINGS}/")) if name in digests else data / name
            (part / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, part / name)
        except (NotFound, FileNotFoundError):
            faults.append(f"{name} is missing")
            continue
        listed[name] = _described(part / name)
        digest = digests.get(name)
        if digest is not None and digest.sha256 != listed[name]["sha256"]:
            faults.append(f"{name} is not what was recorded; run: teachpath doctor")
    listed[DATABASE] = _described(part / DATABASE)
    (part / MANIFEST).write_text(json.dumps({"created_ns": time.time_ns(), "files": listed}, indent=1))
    return Backup(len(listed), sum(each["size"] for each in listed.values()), tuple(faults), distant)


def _described(file: Path) -> dict[str, Any]:
    return {"sha256": _hash(file), "size": file.stat().st_size}


def _verified(source: Path) -> dict[str, dict[str, Any]]:
    """Return the files of a backup, each of which is as it was written."""
    try:
        listed: dict[str, dict[str, Any]] = json.loads((source / MANIFEST).read_text())["files"]
    except (OSError, ValueError, KeyError, TypeError):
        raise UnusableInput(f"{source} is no backup: it has no {MANIFEST} that can be read") from None
    for name, described in listed.items():
        file = source / name
        if not file.resolve().is_relative_to(source.resolve()):
            raise UnusableInput(f"{source / MANIFEST} names {name}, which is outside the backup")
        if not file.is_file() or _hash(file) != described.get("sha256"):
            raise UnusableInput(f"{file} is missing, or not what was backed up; nothing was restored")
    if DATABASE not in listed:
        raise UnusableInput(f"{source} is no backup: it names no {DATABASE}")
    return listed


def _databases(data: Path) -> list[str]:
    return [file.name for file in sorted(data.glob(f"{DATABASE}*")) if f".{REPLACED_FOLDER}" not in file.name]


def _set_aside(former: list[Path], data: Path) -> Path:
    number = 1
    while (aside := data / f"{REPLACED_FOLDER}-{number}").exists():
        number += 1
    aside.mkdir()
    for path in former:
        path.rename(aside / path.name)
    return aside


def _hash(file: Path) -> str:
    digest = sha256()
    with file.open("rb") as stream:
        while piece := stream.read(1 << 20):
            digest.update(piece)
    return digest.hexdigest()


def _sync(folder: Path) -> None:
    for file in folder.rglob("*"):
        if file.is_file():
            with file.open("rb") as stream:
                os.fsync(stream.fileno())


@contextmanager
def _removed_unless_whole(part: Path) -> Iterator[None]:
    """Remove a folder that was begun before, and after a failure; say what is the matter with the disk."""
    shutil.rmtree(part, ignore_errors=True)
    try:
        yield
    except OSError as error:
        shutil.rmtree(part, ignore_errors=True)
        raise storage_fault(error, part) or error from None
    except BaseException:
        shutil.rmtree(part, ignore_errors=True)
        raise
