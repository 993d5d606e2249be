"""Files that nobody but their owner may read or write."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path

from teachpath.errors import UnusableSettings


def write_private(path: Path, content: str) -> None:
    """Write a file whole or not at all, with mode 0600, and its folder with 0700 if there is none; raises OSError."""
    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    handle, name = tempfile.mkstemp(dir=path.parent)  # mkstemp makes it 0600
    try:
        with os.fdopen(handle, "w") as file:
            file.write(content)
        Path(name).replace(path)
    finally:
        Path(name).unlink(missing_ok=True)


def make_private(folder: Path) -> None:
    """Make a folder where there is none, and let nobody but its owner into it.

    Raises:
        UnusableSettings: it is another user's, and others may enter it.
    """
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    mode = stat.S_IMODE(folder.stat().st_mode)
    if os.name == "nt" or not mode & 0o077:
        return
    try:
        folder.chmod(0o700)
    except PermissionError:
        raise UnusableSettings(
            f"others may enter the folder {folder} (mode {mode:04o}), and it is another user's: make it 0700, or name "
            "another with --data"
        ) from None


def refuse_shared(what: str, found: os.stat_result, consequence: str) -> None:
    """Raise UnusableSettings where others may read or write a file.

    Args:
        what: the file is, with its path.
        found: its status.
        consequence: of that, and the way out.
    """
    if os.name == "nt":  # its file modes do not say who may read a file
        return
    mode = stat.S_IMODE(found.st_mode)
    if mode & 0o077:
        raise UnusableSettings(f"others may read or write {what} (mode {mode:04o}, at most 0600): {consequence}")
