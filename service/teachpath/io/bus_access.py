"""Who may do what on the bus: one table of roles and keys, and the Zenoh configuration that enforces it.

The service is the one peer that everybody connects to, so its session filters all that comes and goes. What the table
does not grant is denied.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import datetime, timedelta
from pathlib import Path
from typing import Final

from teachpath.errors import UnusableSettings
from teachpath_proto.logins import Login, Role
from teachpath_proto.sessions import listening_over_tls

RENEWAL: Final = timedelta(days=30)  # before its end, from which a certificate is renewed

# What each verb needs of the filter: messages from the client, and messages to it.
MESSAGES: Final[dict[str, tuple[tuple[str, ...], tuple[str, ...]]]] = {
    "put": (("put",), ("declare_subscriber",)),
    "subscribe": (("declare_subscriber",), ("put", "delete")),
    "serve": (("declare_queryable", "reply"), ("query",)),
    "repeat": (("reply",), ()),
    "ask": (("query",), ("reply", "declare_queryable")),
    "announce": (("liveliness_token",), ()),
    "watch": (("liveliness_query", "declare_liveliness_subscriber"), ("liveliness_token",)),
}

# Everybody may stop the arm. `{only}` is the tracker or robot that a login is held to, else `*`.
STOP_KEYS: Final = {"put": ("executor/stop",), "ask": ("executor/stop",)}
VIEWER_KEYS: Final = (
    "executor/status",
    "executor/journal",
    "robot/*/state",
    "robot/*/setpoint",
    "trackers/*/samples",
    "trackers/*/feedback",
    "jobs/*",
)
# Zenoh's advanced publishers keep a cache and tell their newest number on keys below their own.
CACHE_KEYS: Final = "@adv/**"
ALL_KEYS: Final = ("**", f"**/{CACHE_KEYS}")
GRANTS: Final[dict[Role, dict[str, tuple[str, ...]]]] = {
    # Only a router asks what these two may do: without one, the service is the session that enforces the table.
    Role.SERVICE: {**dict.fromkeys(MESSAGES, ALL_KEYS), "put": ("**",), "serve": ("**",)},
    Role.ROUTER: {},
    Role.EXECUTOR: {
        "put": ("executor/status", "executor/journal", "robot/*/setpoint"),
        "serve": ("executor/command", "executor/stop", "executor/lease"),
        "subscribe": ("executor/stop", "robot/*/state", "trackers/*/samples"),
        "ask": ("robot/*/reset", "station/*"),
        "announce": ("alive/executor/*",),
        "watch": ("alive/robot/*",),
    },
    Role.ROBOT: {
        "put": ("robot/{only}/state", *STOP_KEYS["put"]),
        "serve": ("robot/{only}/reset",),
        "subscribe": ("robot/{only}/setpoint", "executor/status"),
        "ask": STOP_KEYS["ask"],
        "announce": ("alive/robot/{only}",),
    },
    Role.TRACKER: {
        "put": ("trackers/{only}/samples", "scenes/*/object", *STOP_KEYS["put"]),
        "subscribe": ("trackers/{only}/feedback",),
        "ask": ("recorder/*", *STOP_KEYS["ask"]),
        "announce": ("alive/tracker/{only}",),
    },
    Role.OPERATOR: {
        "put": ("scenes/*/object", *STOP_KEYS["put"]),
        "subscribe": VIEWER_KEYS,
        "ask": ("executor/command", "executor/lease", "recorder/*", *STOP_KEYS["ask"]),
        "watch": ("alive/**",),
    },
    Role.VIEWER: {
        "put": STOP_KEYS["put"],
        "subscribe": VIEWER_KEYS,
        "ask": ("recorder/status", *STOP_KEYS["ask"]),
        "watch": ("alive/**",),
    },
}


@dataclass(frozen=True)
class BusAccess:
    """Who is let onto a station's bus; the listening session, or the router, enforces the table for them.

    Attributes:
        own: login of the service.
        logins: of all others.
        expiries: by user, when its certificate ends; without certificates empty.
    """

    own: Login
    logins: tuple[Login, ...]
    expiries: Mapping[str, datetime] = field(default_factory=dict)

    def login(self, role: Role) -> Login:
        """Return the login of a role, for a process that the service starts.

        Raises:
            UnusableSettings: its private key is elsewhere.
        """
        login = next(login for login in self.logins if login.user == role.value)
        if login.certificate and not login.key:
            raise UnusableSettings(
                f"the service starts the {role} itself, and has no private key for its certificate: copy {role}.key "
                "beside it, with mode 0600"
            )
        return login

    def notes(self, now: datetime) -> list[str]:
        """Say whose certificates end soon, and what to do."""
        return [
            f"the certificate of {user} ends on {end:%Y-%m-%d}; renew it with: teachpath station certificates, then "
            "restart the service"
            for user, end in self.expiries.items()
            if end - now < RENEWAL
        ]


@contextmanager
def listening_config(access: BusAccess, prefix: str) -> Iterator[dict[str, object]]:
    """Make the part of Zenoh's configuration that lets in these logins alone, and holds each to its role.

    Zenoh reads passwords from a file while the session opens; the file is removed on leaving.
    """
    rules: dict[str, object] = {"access_control": access_rules(access.logins, prefix)}
    if access.own.certificate:
        yield {**rules, **listening_over_tls(access.own)}
        return
    own = access.own
    lines = [*(f"{login.user}:{login.password}" for login in (own, *access.logins))]
    handle, name = tempfile.mkstemp()
    try:
        with os.fdopen(handle, "w") as file:
            file.write("\n".join(lines) + "\n")
        user = {"user": own.user, "password": own.password, "dictionary_file": name}
        yield {**rules, "transport/auth/usrpwd": user}
    finally:
        Path(name).unlink(missing_ok=True)


def access_rules(logins: Sequence[Login], prefix: str) -> dict[str, object]:
    """Write the table as Zenoh's access control: default deny, one subject a login, named by user or by certificate."""
    rules: list[dict[str, object]] = []
    policies = []
    for login in logins:
        names = []
        # Who hears all trackers declares one key for them all, which a login that is held to one of them must hear of.
        listened = granted(replace(login, only=""), prefix)["put"]
        for verb, own in granted(login, prefix).items():
            for flow, messages in zip(("ingress", "egress"), MESSAGES[verb], strict=True):
                keys = listened if (verb, flow) == ("put", "egress") else own
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
        if names:
            policies.append({"rules": names, "subjects": [login.user]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": [
            {"id": login.user, "cert_common_names": [login.common_name]}
            if login.certificate
            else {"id": login.user, "usernames": [login.user]}
            for login in logins
        ],
        "policies": policies,
    }


def granted(login: Login, prefix: str) -> dict[str, list[str]]:
    """Return the full keys that a login may use, by verb."""
    found = {
        verb: [f"{prefix}/{key.format(only=login.only or '*')}" for key in keys]
        for verb, keys in GRANTS[login.role].items()
    }
    found["repeat"] = found.get("put", [])  # from its cache, with the keys under which it was put
    cached = [f"{key}/{CACHE_KEYS}" for key in found["repeat"]]
    for verb in ("put", "serve"):
        found[verb] = found.get(verb, []) + cached
    return found
