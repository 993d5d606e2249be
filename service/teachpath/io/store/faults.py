"""Faults of disk and database, as sentences with the way out."""

from __future__ import annotations

import errno
import os
import sqlite3
from typing import Final

from sqlalchemy.exc import DataError, DBAPIError, IntegrityError, InterfaceError, OperationalError

from teachpath.errors import Conflict, StorageFull, StorageUnavailable, TeachpathError, UnusableInput

TEMPORARY: Final = ".temporary"  # ends the name of a file that is being written and renamed when it is whole
FREE_SPACE: Final = "free space, then try again"
RESTORE: Final = (
    "restore a backup (teachpath restore), or make the rows anew from the recordings: teachpath doctor --rebuild"
)
# By the SQLSTATE of a server, or by its class: what is the matter, and the way out.
RACES: Final = ("40", "55P03")  # transactions that lost against others; nothing of them was stored
DISK_FULL: Final = "53100"
SERVER: Final = {
    "25006": ("may only be read", "name the primary server in the setting store.database"),
    "42501": ("may not be used so by this user", "let its owner grant that, or name another user in store.database"),
    "42P01": ("lacks a table", "restart the service, which makes its tables"),
    "53": ("has no room for this", "raise max_connections or the memory of its server"),
    "57": ("does not answer now", "is its server being restarted?"),
    "58": ("cannot be read or written", "look at the disk of its server: it reports an error of its own"),
    "XX": ("is damaged", "look at the log of its server, and restore a backup of it"),
}
FULL_STORAGE_ERRORS: Final = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})
REFUSAL_SUGGESTIONS: Final = {
    errno.EROFS: "mount it for writing, or name another folder with --data",
    errno.EACCES: "let this user read and write it, or name another folder with --data",
    errno.EPERM: "let this user read and write it, or name another folder with --data",
    errno.EIO: "look at the disk: it reports an error of its own",
    errno.ENOTDIR: "name another folder with --data",
    errno.EMFILE: "raise the number of files that this user may open (ulimit -n)",
}
# By the names of SQLite's result codes, the extended ones too: what is the matter, and the way out.
SQLITE: Final = {
    "SQLITE_BUSY": ("is locked by another process", "end that process, then try again"),
    "SQLITE_LOCKED": ("is locked by another process", "end that process, then try again"),
    "SQLITE_READONLY": (
        "may only be read",
        "let this user write it and its folder, or name another folder with --data",
    ),
    "SQLITE_PERM": ("may not be opened", "let this user read and write it and its folder"),
    "SQLITE_CANTOPEN": ("cannot be opened", "let this user read and write it and its folder"),
    "SQLITE_CORRUPT": ("is damaged", RESTORE),
    "SQLITE_NOTADB": ("is no database", RESTORE),
    "SQLITE_IOERR": ("cannot be read or written", "look at the disk: it reports an error of its own"),
}


def storage_fault(error: OSError, place: object) -> StorageUnavailable | None:
    """Return what an error of the disk says to the operator; None: it is no fault of the disk.

    Args:
        error: as the system raised it.
        place: file or folder, where the error names none.
    """
    if error.errno in FULL_STORAGE_ERRORS:
        return StorageFull(f"{error.filename or place}: {error.strerror}; {FREE_SPACE}")
    if error.errno in REFUSAL_SUGGESTIONS:
        return StorageUnavailable(f"{error.filename or place}: {error.strerror}; {REFUSAL_SUGGESTIONS[error.errno]}")
    return None


def database_fault(error: BaseException, url: str) -> TeachpathError | None:
    """Return what an error of the database says to the operator; None: it is a fault of the statement.

    Args:
        error: of SQLAlchemy, or of the driver.
        url: of the database, without a password.
    """
    cause = error.orig if isinstance(error, DBAPIError) else error
    if isinstance(error, (IntegrityError, sqlite3.IntegrityError)):
        return Conflict(f"it was stored or changed by somebody else meanwhile ({cause}); read it anew, then try again")
    if isinstance(error, DataError):
        return UnusableInput(f"the database cannot keep this: {_first_line(cause)}; leave out what is no text")
    if isinstance(cause, sqlite3.Error):
        return _sqlite_fault(cause, url)
    if (state := getattr(cause, "sqlstate", None)) and (fault := _server_fault(state, cause, url)) is not None:
        return fault
    if isinstance(error, (OperationalError, InterfaceError)):
        return StorageUnavailable(f"the database {url} does not answer ({_first_line(cause)}); is its server running?")
    return None


def refused_by_server(error: BaseException, url: str) -> StorageUnavailable:
    """Return what it says to the operator that no connection to a database's server can be made."""
    return StorageUnavailable(
        f"cannot connect to the database {url}: {_first_line(error)}; is its server running, and the setting "
        "store.database right?"
    )


def _server_fault(state: str, cause: BaseException | None, url: str) -> TeachpathError | None:
    if state.startswith(RACES):
        return Conflict(f"somebody else changed the same meanwhile ({_first_line(cause)}); try again")
    if state == DISK_FULL:
        return StorageFull(f"{url}: the disk of the database is full; {FREE_SPACE}")
    if (told := SERVER.get(state) or SERVER.get(state[:2])) is not None:
        return StorageUnavailable(f"the database {url} {told[0]} ({_first_line(cause)}); {told[1]}")
    return None


def _sqlite_fault(error: sqlite3.Error, url: str) -> StorageUnavailable | None:
    name = getattr(error, "sqlite_errorname", "") or ""
    if name.startswith("SQLITE_FULL") or (name.startswith("SQLITE_IOERR") and _is_full(url)):
        return StorageFull(f"{url}: the disk of the database is full; {FREE_SPACE}")
    for code, (what, advice) in SQLITE.items():
        if name == code or name.startswith(f"{code}_"):
            return StorageUnavailable(f"the database {url} {what} ({error}); {advice}")
    return None


def _is_full(url: str) -> bool:
    """Return whether no block is left; SQLite reports an error of its own where it cannot extend a file of its own."""
    folder = os.path.dirname(url.partition(":///")[2]) or "."
    try:
        return os.statvfs(folder).f_bavail == 0
    except OSError:
        return False


def _first_line(error: BaseException | None) -> str:
    return str(error).strip().partition("\n")[0]
