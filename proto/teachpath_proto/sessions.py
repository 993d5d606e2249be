"""How a program opens its Zenoh session with a station: it meets the named endpoints and nobody else."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence

import zenoh

from teachpath_proto.logins import Login

# Nothing leaves the machine unasked: no multicast, no gossip. Nor do messages go through shared memory: to prepare it
# at the first long message makes setpoints late, and a process that is killed leaves its files behind. A session that
# gets no turn for long stays open: an executor without one took it for the end of the arm's driver. Whoever ends or
# dies is gone at once all the same, and silence is noticed by those who listen. Setpoints are dropped where a line is
# full: they find room for more than a second of them, 16 times 64 KiB.
DISCOVERY_OFF: Mapping[str, object] = {
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": False,
    "transport/shared_memory/enabled": False,
    "transport/link/tx/lease": 60_000,
    "transport/link/tx/queue/size/real_time": 16,
}
TLS = "transport/link/tls"


def open_session(values: Mapping[str, object]) -> zenoh.Session:
    """Open a session with these values of Zenoh's configuration, by their path in it; raises zenoh.ZError."""
    config = zenoh.Config()
    for path, value in values.items():
        config.insert_json5(path, json.dumps(value))
    return zenoh.open(config)


def is_tls(endpoint: str) -> bool:
    """Tell whether programs say by certificates who they are at `endpoint`."""
    return endpoint.startswith("tls/")


def listening(endpoints: Sequence[str], mode: str = "peer") -> dict[str, object]:
    """Return the values of the one session that the others connect to.

    A peer does not route between other peers, but it does between its clients; a router does between all.
    """
    return {**DISCOVERY_OFF, "mode": mode, "listen/endpoints": list(endpoints)}


def joining(endpoint: str, login: Login | None, *, timeout: float) -> dict[str, object]:
    """Return the values of a client of `endpoint`.

    Args:
        endpoint: where the station or its router listens.
        login: who the program is there; None where nobody asks.
        timeout: [s] to connect in.
    """
    values: dict[str, object] = {
        **DISCOVERY_OFF,
        "mode": "client",
        "connect/endpoints": [endpoint],
        "connect/timeout_ms": int(timeout * 1000),
        "connect/exit_on_failure": True,
    }
    if login is not None and login.certificate:
        values[TLS] = {
            "root_ca_certificate_base64": _base64(login.authority),
            "connect_certificate_base64": _base64(login.certificate),
            "connect_private_key_base64": _base64(login.key),
            "enable_mtls": True,
            "verify_name_on_connect": True,
            "close_link_on_expiration": True,
        }
    elif login is not None:
        values["transport/auth/usrpwd"] = {"user": login.user, "password": login.password}
    return values


def listening_over_tls(login: Login) -> dict[str, object]:
    """Return the values with which a listening session shows its certificate, and asks everybody for theirs."""
    return {
        TLS: {
            "root_ca_certificate_base64": _base64(login.authority),
            "listen_certificate_base64": _base64(login.certificate),
            "listen_private_key_base64": _base64(login.key),
            "enable_mtls": True,
            "close_link_on_expiration": True,
        }
    }


def _base64(text: str) -> str:
    return base64.b64encode(text.encode()).decode()
