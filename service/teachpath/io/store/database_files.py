"""The file of a SQLite database: where it is, a consistent copy of it, and out of the way with a damaged one."""

from __future__ import annotations

import sqlite3
from contextlib import closing, suppress
from pathlib import Path
from typing import Final

from sqlalchemy.engine import make_url
from sqlalchemy.exc import ArgumentError

from teachpath.errors import StorageUnavailable
from teachpath.io.store.faults import database_fault, storage_fault
from teachpath.io.store.settings import StoreSettings

DATABASE: Final = "teachpath.sqlite"
REPLACED_SUFFIX: Final = ".aside"
SIDE_FILES: Final = ("-wal", "-shm")  # that SQLite keeps beside a database
TIMEOUT: Final = 5.0  # [s] for which a copy waits for somebody who writes


def make_data_folder(settings: StoreSettings) -> Path:
    """Return the folder of a store; made when missing, for its user alone. Raises StorageUnavailable."""
    folder = Path(settings.data_dir)
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    except OSError as error:
        raise storage_fault(error, folder) or error from None
    return folder


def make_database_file(settings: StoreSettings) -> None:
    """Make the file of a database where there is none, for its user alone: hashes of passwords are in it.

    SQLite gives the files beside it the same mode, and says what is wrong where it cannot be made.
    """
    file = database_file(settings)
    if file is not None and not file.exists():
        with suppress(OSError):
            file.touch(mode=0o600)


def database_url(settings: StoreSettings) -> str:
    """Return the URL of a store's database."""
    return settings.database or f"sqlite:///{Path(settings.data_dir) / DATABASE}"


def database_file(settings: StoreSettings) -> Path | None:
    """Return the file of a store's database; None where it has a server, or is in memory."""
    try:
        url = make_url(database_url(settings))
    except ArgumentError:  # which the engine says
        return None
    return Path(url.database) if url.get_backend_name() == "sqlite" and url.database else None


def copy_database(file: Path, to: Path) -> None:
    """Copy a database as it stands between two transactions, while others read and write it.

    Raises:
        StorageUnavailable: it cannot be read, or is damaged.
        StorageFull: there is no room for the copy.
    """
    try:
        read_only = f"{file.absolute().as_uri()}?mode=ro"
        with (
            closing(sqlite3.connect(read_only, uri=True, timeout=TIMEOUT)) as source,
            closing(sqlite3.connect(to)) as target,
        ):
            source.backup(target)
    except sqlite3.Error as error:
        to.unlink(missing_ok=True)
        fault = database_fault(error, str(file))
        raise fault or StorageUnavailable(f"the database {file} cannot be copied to {to}: {error}") from None


def set_database_aside(file: Path) -> Path | None:
    """Rename a database so that a new one can take its place; return its new name, or None where there is none."""
    if not file.exists():
        return None
    number = 1
    while (aside := file.with_name(f"{file.name}{REPLACED_SUFFIX}-{number}")).exists():
        number += 1
    for ending in SIDE_FILES:  # first: without them it would lose its last transactions
        beside = file.with_name(file.name + ending)
        if beside.exists():
            beside.rename(aside.with_name(aside.name + ending))
    return file.rename(aside)
