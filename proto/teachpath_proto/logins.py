"""The logins of a station's bus: the roles, and where programs of the same user find theirs.

A station keeps its logins in one file that only its owner may read. A program of that user takes the login of its role
from there; a program of another user or machine is given a file with its own login (`teachpath login create`).
"""

from __future__ import annotations

import json
import os
import re
import tempfile
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from pathlib import Path

GENERATION_MARK = "#"  # in a common name; no name of a login has it


class Role(StrEnum):
    """What a login may do on the bus; the service grants each role its keys (`teachpath.io.bus_access`)."""

    SERVICE = "service"  # the station itself, that all others meet
    EXECUTOR = "executor"  # sends setpoints, answers commands
    ROBOT = "robot"  # the arm's driver: takes setpoints, publishes joint states
    TRACKER = "tracker"  # publishes samples, controls the recording of its hand
    OPERATOR = "operator"  # a program that commands the executor
    VIEWER = "viewer"  # looks on
    ROUTER = "router"  # passes on between machines what the others say


@dataclass(frozen=True, slots=True)
class Login:
    """A user of the bus, with a password, or over TLS with a certificate; all in PEM, empty where there is none."""

    user: str
    password: str = field(repr=False)
    role: Role
    only: str = ""  # the one tracker or robot it may be; empty: any
    certificate: str = ""  # that names the user
    key: str = field(default="", repr=False)  # private, of the certificate
    authority: str = ""  # certificate of the authority that signs those of the station
    generation: int = 1  # of the certificates of this name: a name that was revoked goes on with the next

    @property
    def common_name(self) -> str:
        """Name on the certificate; that of an earlier generation is another one, and may do nothing."""
        return self.user if self.generation == 1 else f"{self.user}{GENERATION_MARK}{self.generation}"


def logins_path(endpoint: str) -> Path:
    """Return the file of the logins of the station at `endpoint`, in this user's state folder (XDG_STATE_HOME)."""
    base = os.environ.get("XDG_STATE_HOME") or os.environ.get("LOCALAPPDATA")
    folder = Path(base) if base else Path.home() / ".local" / "state"
    return folder / "teachpath" / (re.sub(r"[^A-Za-z0-9.]+", "-", endpoint) + ".json")


def read_logins(path: Path) -> list[Login]:
    """Read a file of logins; none where there is no file.

    Raises:
        ValueError: the file cannot be read or is no file of logins; the sentence names it and the way out.
    """
    try:
        return [Login(**{**one, "role": Role(one["role"])}) for one in json.loads(path.read_text())["logins"]]
    except FileNotFoundError:
        return []
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ValueError(
            f"{path} holds no logins of a station ({error}); remove it and start the service again: it writes a new one"
        ) from None


def write_logins(path: Path, logins: Iterable[Login]) -> None:
    """Write a file of logins at once and whole; nobody but its owner may read it."""
    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    handle, name = tempfile.mkstemp(dir=path.parent)  # mkstemp makes it 0600
    with os.fdopen(handle, "w") as file:
        json.dump({"logins": [asdict(login) for login in logins]}, file, indent=1)
    Path(name).replace(path)


def find_login(endpoint: str, role: Role) -> Login | None:
    """Return this user's login of a role at `endpoint`; None where the station keeps none for this user.

    Raises:
        ValueError: the file of logins cannot be read.
    """
    return next((login for login in read_logins(logins_path(endpoint)) if login.role is role), None)
