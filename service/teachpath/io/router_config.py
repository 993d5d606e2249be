"""The configuration of a Zenoh router that lets programs of several machines meet, each held to its role."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Final

from teachpath.io.bus_access import access_rules
from teachpath.io.bus_settings import BusSettings
from teachpath_proto.logins import Login, Role
from teachpath_proto.sessions import DISCOVERY_OFF, TLS

HEADER: Final = """\
// A Zenoh router for a station whose programs run on several machines; `teachpath station router` writes this file:
//
//   teachpath station certificates --host NAME   # with bus.mode = "client" and bus.endpoint = "tls/NAME:7447"
//   teachpath station router > zenohd.json5      # again after every `teachpath login create` and `login revoke`
//   zenohd --config zenohd.json5
//
// Everybody shows a certificate of the station's authority; its common name decides what passes, and nothing else does.
"""


def router_config(bus: BusSettings, logins: Sequence[Login]) -> str:
    """Write the configuration of a router for these logins, as zenohd reads it (JSON5)."""
    listed = [login for login in logins if login.role is not Role.ROUTER]
    folder = bus.certificates
    tls = {
        "root_ca_certificate": f"{folder}/authority.pem",
        "listen_certificate": f"{folder}/router.pem",
        "listen_private_key": f"{folder}/router.key",
        "enable_mtls": True,
        "close_link_on_expiration": True,
    }
    values: dict[str, object] = {
        "mode": "router",
        "listen/endpoints": [bus.endpoint],
        **DISCOVERY_OFF,
        TLS: tls,
        "access_control": access_rules(listed, bus.prefix),
    }
    return HEADER + _document(_nested(values)) + "\n"


def _nested(values: dict[str, object]) -> dict[str, object]:
    """Turn paths of settings into objects within objects."""
    document: dict[str, object] = {}
    for path, value in values.items():
        *above, last = path.split("/")
        place = document
        for name in above:
            place = place.setdefault(name, {})  # type: ignore[assignment]
        place[last] = value
    return document


def _document(value: object, indent: str = "") -> str:
    """Write JSON with one line for every rule, subject and policy."""
    inner = indent + "  "
    if isinstance(value, dict) and any(isinstance(v, dict | list) for v in value.values()) and "id" not in value:
        lines = [f"{inner}{json.dumps(name)}: {_document(v, inner)}" for name, v in value.items()]
        return "{\n" + ",\n".join(lines) + f"\n{indent}}}"
    if isinstance(value, list) and any(isinstance(v, dict) for v in value):
        return "[\n" + ",\n".join(f"{inner}{json.dumps(v)}" for v in value) + f"\n{indent}]"
    return json.dumps(value)
