"""Where a program finds the token by which it tells a station who it is."""

from __future__ import annotations

import os
import re
import stat
import tempfile
from pathlib import Path
from typing import Final
from urllib.parse import urlsplit

TOKEN_VARIABLE: Final = "TEACHPATH_TOKEN"
TOKEN = re.compile(r"[A-Za-z0-9._~+/=-]{1,128}")
MAX_FILE_SIZE: Final = 1024  # bytes


def token_path(url: str) -> Path:
    """Return the file of this user's token for the station at `url`, in the state folder (XDG_STATE_HOME)."""
    base = os.environ.get("XDG_STATE_HOME") or os.environ.get("LOCALAPPDATA")
    folder = Path(base) if base else Path.home() / ".local" / "state"
    return folder / "teachpath" / (re.sub(r"[^A-Za-z0-9.]+", "-", _origin(url)) + ".token")


def find_token(url: str) -> str:
    """Return the token for the station at `url`: of the variable TEACHPATH_TOKEN, else of this user's file.

    Returns:
        An empty text where there is none; a station that does not ask needs none.

    Raises:
        ValueError: it cannot be used, or others may read it; the sentence has the way out.
    """
    if token := os.environ.get(TOKEN_VARIABLE, ""):
        return checked_token(token, f"the variable {TOKEN_VARIABLE}")
    path = token_path(url)
    try:
        with path.open() as file:
            mode = stat.S_IMODE(os.fstat(file.fileno()).st_mode)
            text = file.read(MAX_FILE_SIZE)
    except FileNotFoundError:
        return ""
    except (OSError, ValueError) as error:
        raise ValueError(f"cannot read the token {path} ({error}); remove it, or make it this user's") from None
    if os.name != "nt" and mode & 0o077:
        raise ValueError(
            f"others may read the token {path} (mode {mode:04o}, at most 0600), and be you: revoke it and make "
            f"another, or where nobody else can have read it: chmod 600 {path}"
        )
    return checked_token(text.strip(), str(path))


def write_token(path: Path, token: str) -> None:
    """Write a token at once and whole; nobody but its owner may read it."""
    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    handle, name = tempfile.mkstemp(dir=path.parent)  # mkstemp makes it 0600
    with os.fdopen(handle, "w") as file:
        file.write(f"{token}\n")
    Path(name).replace(path)


def checked_token(token: str, place: str) -> str:
    """Return a token; raises ValueError where it could not be sent as one."""
    if not TOKEN.fullmatch(token):
        raise ValueError(f"{place} holds no token: it has 1 to 128 letters, digits and . _ ~ + / = -")
    return token


def _origin(url: str) -> str:
    parts = urlsplit(url)
    return f"{parts.scheme}-{parts.netloc.rpartition('@')[2]}".lower()
