"""The file of a station's signing key, beside its logins; nobody but its owner may read it."""

from __future__ import annotations

import os
import secrets
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Final

from teachpath.errors import UnusableSettings
from teachpath.io.private_files import refuse_shared
from teachpath_proto.logins import logins_path

KEY_BYTES: Final = 32


def signing_key_path(endpoint: str) -> Path:
    """Return the file of the signing key of the station at `endpoint`, in this user's state folder."""
    return logins_path(endpoint).with_suffix(".key")


def prepare_signing_key(endpoint: str) -> bytes:
    """Return the signing key of the station at `endpoint`; it is made at the first start.

    Raises:
        UnusableSettings: see `read_signing_key`, or the file cannot be written.
    """
    path = signing_key_path(endpoint)
    try:
        path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        if not path.exists():
            _create(path)
    except OSError as error:
        raise UnusableSettings(
            f"cannot write the signing key {path}: {error.strerror}; make its folder writable"
        ) from None
    return read_signing_key(endpoint)


def read_signing_key(endpoint: str) -> bytes:
    """Read the signing key of the station at `endpoint`.

    Raises:
        UnusableSettings: there is none, it is no key, or others may read or write it; the sentence has the way out.
    """
    path = signing_key_path(endpoint)
    try:
        with path.open("rb") as file:
            refuse_shared(
                f"the signing key {path}",
                os.fstat(file.fileno()),
                "whoever has read it can sign plans; remove it and start the service again, then plan the paths again, "
                f"or where nobody else can have read it: chmod 600 {path}",
            )
            content = file.read(4 * KEY_BYTES)
        key = bytes.fromhex(content.decode("ascii").strip())
    except FileNotFoundError:
        raise UnusableSettings(
            f"there is no signing key {path}: start the service first (teachpath serve), it makes one; an executor on "
            "another machine or of another user needs a copy of the service's, mode 0600"
        ) from None
    except OSError as error:
        raise UnusableSettings(
            f"cannot read the signing key {path}: {error.strerror}; it has to be this user's"
        ) from None
    except ValueError:
        key = b""
    if len(key) != KEY_BYTES:
        raise UnusableSettings(
            f"{path} is no signing key of {KEY_BYTES} bytes in hexadecimal digits; remove it and start the service "
            "again: it makes a new one, and paths have to be planned again"
        )
    return key


def _create(path: Path) -> None:
    """Write a new key whole or not at all; one that another process made meanwhile stays."""
    handle, name = tempfile.mkstemp(dir=path.parent)  # mkstemp makes it 0600
    try:
        with os.fdopen(handle, "w") as file:
            file.write(secrets.token_hex(KEY_BYTES) + "\n")
        with suppress(FileExistsError):
            os.link(name, path)
    finally:
        Path(name).unlink(missing_ok=True)
