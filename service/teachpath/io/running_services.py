"""The services of this user that run: each leaves its addresses in a file, which it holds locked while it lives."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

from teachpath_proto.logins import logins_path


@dataclass(frozen=True, order=True)
class RunningService:
    """A service of this user that runs.

    Attributes:
        url: of its web port.
        endpoint: where its bus is joined; empty: it does not say.
        prefix: of the keys on its bus.
    """

    url: str
    endpoint: str = ""
    prefix: str = ""


def running_folder() -> Path:
    """Return the folder of the addresses, beside the logins of this user."""
    return logins_path("running").with_suffix("")


@contextmanager
def announced(url: str, endpoint: str = "", prefix: str = "") -> Iterator[None]:
    """Let programs of this user find the service at `url` meanwhile; without a place to write they find none."""
    file = running_folder() / f"{os.getpid()}.json"
    try:
        file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        stream = file.open("w")
    except OSError:
        yield
        return
    with stream:
        fcntl.flock(stream, fcntl.LOCK_EX)
        stream.write(json.dumps(asdict(RunningService(url, endpoint, prefix))))
        stream.flush()
        try:
            yield
        finally:
            file.unlink(missing_ok=True)


def running_services() -> list[RunningService]:
    """Return the services of this user that run, in the order of their addresses; what a killed one left is removed."""
    found = []
    for file in running_folder().glob("*.json"):
        try:
            with file.open() as stream:
                if _is_held(stream.fileno()):
                    found.append(RunningService(**json.load(stream)))
                else:
                    file.unlink(missing_ok=True)
        except (OSError, ValueError, TypeError):
            continue
    return sorted(found)


def _is_held(file: int) -> bool:
    try:
        fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError:
        return True
    return False
