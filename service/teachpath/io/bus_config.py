"""A file of Zenoh's own configuration for the service's session; what the station sets itself is refused there."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from teachpath.errors import UnusableSettings
from teachpath.io.bus_settings import BusSettings
from teachpath_proto.sessions import TLS, is_tls

# Keys that the station sets itself -> where a file says the same instead.
STATION_KEYS: Final = {
    "mode": "it is the setting bus.mode",
    "namespace": "every key begins with the setting bus.prefix",
    "listen": "the station listens at the setting bus.endpoint",
    "scouting": "a station looks for nobody; routers join it with a login (deploy/zenohd-site.json5)",
    "access_control": "what a login may do follows from its role; make one with: teachpath login create",
    "transport/auth": "logins have their passwords from: teachpath login create",
}
OF_A_CLIENT: Final = {"connect": "with bus.mode client it joins the router at the setting bus.endpoint"}
# The table of roles knows nobody whom the station itself has called, so that nothing would pass.
OF_ACCESS_CONTROL: Final = {
    "connect": "where it asks for logins, a further router joins it with one of its own (deploy/zenohd-site.json5)"
}
OF_TLS: Final = {TLS: "it shows the certificates in the folder of the setting bus.certificates"}


def read_bus_config(bus: BusSettings) -> dict[str, Any]:
    """Return what the file `bus.config` says, by the first word of each key; without a file nothing.

    Raises:
        UnusableSettings: it cannot be read, is not JSON5, or sets what the station sets itself.
    """
    if not bus.config:
        return {}
    document = _read(Path(bus.config))
    own = STATION_KEYS | (OF_ACCESS_CONTROL if bus.access_control else {})
    own |= (OF_A_CLIENT if bus.mode == "client" else {}) | (OF_TLS if is_tls(bus.endpoint) else {})
    for key, instead in own.items():
        if _has(document, key.split("/")):
            raise UnusableSettings(f"{bus.config} (bus.config) sets {key}, which the station does itself: {instead}")
    return document


def _read(path: Path) -> dict[str, Any]:
    import json5  # where there is a file

    try:
        document = json5.loads(path.read_text(), allow_duplicate_keys=False)
    except OSError as error:
        raise UnusableSettings(
            f"cannot read {path} (bus.config): {error.strerror}; name a file of this user's, or none"
        ) from None
    except (ValueError, RecursionError) as error:
        raise UnusableSettings(f"{path} (bus.config) is not JSON5: {error}") from None
    if not isinstance(document, dict):
        raise UnusableSettings(f"{path} (bus.config) is not an object of Zenoh's settings, {{...}}")
    return document


def _has(document: object, words: list[str]) -> bool:
    return not words or (isinstance(document, dict) and words[0] in document and _has(document[words[0]], words[1:]))
