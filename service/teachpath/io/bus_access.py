"""Who may do what on the bus: one table of roles and keys, and the Zenoh configuration that enforces it.

The service is the one peer that everybody connects to, so its session filters all that comes and goes. What the table
does not grant is denied.
"""

from __future__ import annotations

import os
import secrets
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from teachpath.errors import UnusableSettings
from teachpath_proto.logins import Login, Role, find_login, logins_path, read_logins, write_logins

PASSWORD_BYTES = 24
SERVICE = "service"  # user name of the listening session
# Roles whose logins lie in the file for this user's programs; the executor's is given to its process alone.
LOCAL: Final = (Role.ROBOT, Role.TRACKER, Role.OPERATOR, Role.VIEWER)

# What each verb needs of the filter: messages from the client, and messages to it.
MESSAGES: Final[dict[str, tuple[tuple[str, ...], tuple[str, ...]]]] = {
    "put": (("put",), ("declare_subscriber",)),
    "subscribe": (("declare_subscriber",), ("put", "delete")),
    "serve": (("declare_queryable", "reply"), ("query",)),
    "ask": (("query",), ("reply", "declare_queryable")),
    "announce": (("liveliness_token",), ()),
    "watch": (("liveliness_query", "declare_liveliness_subscriber"), ("liveliness_token",)),
}

# Everybody may stop the arm. `{only}` is the tracker or robot that a login is held to, else `*`.
STOP: Final = {"put": ("executor/stop",), "ask": ("executor/stop",)}
LOOK: Final = (
    "executor/status",
    "executor/journal",
    "robot/*/state",
    "robot/*/setpoint",
    "trackers/*/samples",
    "trackers/*/feedback",
    "jobs/*",
)
GRANTS: Final[dict[Role, dict[str, tuple[str, ...]]]] = {
    Role.EXECUTOR: {
        "put": ("executor/status", "executor/journal", "robot/*/setpoint"),
        "serve": ("executor/command", "executor/stop", "executor/lease"),
        "subscribe": ("executor/stop", "robot/*/state", "trackers/*/samples"),
        "ask": ("robot/*/reset", "station/*"),
        "announce": ("alive/executor/*",),
    },
    Role.ROBOT: {
        "put": ("robot/{only}/state", *STOP["put"]),
        "serve": ("robot/{only}/reset",),
        "subscribe": ("robot/{only}/setpoint", "executor/status"),
        "ask": STOP["ask"],
        "announce": ("alive/robot/{only}",),
    },
    Role.TRACKER: {
        "put": ("trackers/{only}/samples", *STOP["put"]),
        "subscribe": ("trackers/{only}/feedback",),
        "ask": ("recorder/*", *STOP["ask"]),
        "announce": ("alive/tracker/{only}",),
    },
    Role.OPERATOR: {
        "put": STOP["put"],
        "subscribe": LOOK,
        "ask": ("executor/command", "executor/lease", "recorder/*", *STOP["ask"]),
        "watch": ("alive/**",),
    },
    Role.VIEWER: {
        "put": STOP["put"],
        "subscribe": LOOK,
        "ask": ("recorder/status", *STOP["ask"]),
        "watch": ("alive/**",),
    },
}
# Zenoh's advanced publishers keep a cache and tell their newest number on keys below their own.
CACHE_KEYS: Final = "@adv/**"


@dataclass(frozen=True, slots=True)
class BusAccess:
    """All logins of a station, and its own password; the listening session enforces the table for them."""

    password: str
    logins: tuple[Login, ...]

    def login(self, role: Role) -> Login:
        """Return the first login of a role."""
        return next(login for login in self.logins if login.role is role)


def prepare_access(endpoint: str) -> BusAccess:
    """Return the logins of the station at `endpoint`, and make those that are missing.

    Local programs find theirs in the file of `logins_path`. They outlast a restart, so that a tracker comes back by
    itself. The executor's login is new each time and in no file.

    Raises:
        UnusableSettings: the file of logins cannot be read or written; the sentence has the way out.
    """
    path = logins_path(endpoint)
    try:
        kept = read_logins(path)
        missing = [Login(role.value, new_password(), role) for role in LOCAL if role not in {k.user for k in kept}]
        if missing or not path.exists():
            write_logins(path, [*kept, *missing])
    except ValueError as error:
        raise UnusableSettings(str(error)) from None
    except OSError as error:
        raise UnusableSettings(f"cannot write the logins {path}: {error.strerror}; make its folder writable") from None
    executor = Login(Role.EXECUTOR.value, new_password(), Role.EXECUTOR)
    return BusAccess(new_password(), (executor, *kept, *missing))


def local_login(endpoint: str, role: Role) -> Login | None:
    """Return this user's login of a role at `endpoint`; None where the station keeps none for this user.

    Raises:
        UnusableSettings: the file of logins cannot be read.
    """
    try:
        return find_login(endpoint, role)
    except ValueError as error:
        raise UnusableSettings(str(error)) from None


def new_password() -> str:
    """Return a password that nobody guesses."""
    return secrets.token_urlsafe(PASSWORD_BYTES)


@contextmanager
def listening_config(access: BusAccess, prefix: str) -> Iterator[dict[str, object]]:
    """Make the part of Zenoh's configuration that lets in these logins alone, and holds each to its role.

    Zenoh reads the passwords from a file while the session opens; the file is removed on leaving.
    """
    lines = [f"{SERVICE}:{access.password}", *(f"{login.user}:{login.password}" for login in access.logins)]
    handle, name = tempfile.mkstemp()
    try:
        with os.fdopen(handle, "w") as file:
            file.write("\n".join(lines) + "\n")
        yield {
            "transport/auth/usrpwd": {"user": SERVICE, "password": access.password, "dictionary_file": name},
            "access_control": access_rules(access.logins, prefix),
        }
    finally:
        Path(name).unlink(missing_ok=True)


def access_rules(logins: Sequence[Login], prefix: str) -> dict[str, object]:
    """Write the table as Zenoh's access control: default deny, one subject a login."""
    rules: list[dict[str, object]] = []
    policies = []
    for login in logins:
        names = []
        for verb, keys in granted(login, prefix).items():
            for flow, messages in zip(("ingress", "egress"), MESSAGES[verb], strict=True):
                if messages:
                    names.append(f"{login.user} {verb} {flow}")
                    rules.append(
                        {
                            "id": names[-1],
                            "permission": "allow",
                            "flows": [flow],
                            "messages": list(messages),
                            "key_exprs": list(keys),
                        }
                    )
        policies.append({"rules": names, "subjects": [login.user]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": [{"id": login.user, "usernames": [login.user]} for login in logins],
        "policies": policies,
    }


def granted(login: Login, prefix: str) -> dict[str, list[str]]:
    """Return the full keys that a login may use, by verb."""
    found = {
        verb: [f"{prefix}/{key.format(only=login.only or '*')}" for key in keys]
        for verb, keys in GRANTS[login.role].items()
    }
    cached = [f"{key}/{CACHE_KEYS}" for key in found.get("put", [])]
    for verb in ("put", "serve"):
        found[verb] = found.get(verb, []) + cached
    return found
