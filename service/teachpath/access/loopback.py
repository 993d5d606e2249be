"""What keeps a station that does not ask who somebody is to its own machine."""

from __future__ import annotations

from collections.abc import Collection
from ipaddress import IPv6Address, ip_address
from urllib.parse import urlsplit

from teachpath.errors import UnusableSettings

WAY_OUT = (
    'set auth.mode = "token" and make a token for everybody (teachpath token create), or "proxy" where a proxy asks '
    "who somebody is (docs/access.md)"
)


def is_loopback(host: str) -> bool:
    """Tell whether a host, by name or address and without a port, is this machine alone."""
    if host.lower() == "localhost":
        return True
    try:
        address = ip_address(host.strip("[]"))
    except ValueError:
        return False
    mapped = address.ipv4_mapped if isinstance(address, IPv6Address) else None
    return (mapped or address).is_loopback


def host_of(authority: str) -> str:
    """Return the host of `host:port`, as a header or an address has it; IPv6 addresses stand in brackets there.

    What has a user name before the host stays whole, which is no host.
    """
    if "@" in authority:
        return authority
    if authority.startswith("["):
        return authority[: authority.find("]") + 1]
    return authority.partition(":")[0]


def authority_of(origin: str) -> str:
    """Return `host:port` of the header Origin, in small letters; empty where it names none or is no address."""
    try:
        return urlsplit(origin).netloc.lower()
    except ValueError:
        return ""


def require_safe_binding(mode: str, host: str, hosts: Collection[str], proxies: Collection[str] = ()) -> None:
    """Check where a station may listen, and under which names it may be reached.

    Args:
        mode: of authentication.
        host: address to listen on.
        hosts: further names.
        proxies: that are believed about who asks.

    Raises:
        UnusableSettings: it would be open to whoever reaches it, or to pages of other sites; the sentence has the way
            out.
    """
    for name in hosts:
        if "*" in name:
            raise UnusableSettings(
                f"setting web.hosts holds {name!r}: a page of any site could pass for this station's own "
                "(DNS rebinding); name each host under which it is reached"
            )
    if mode == "none":
        opened = [("web.host", host), *(("web.hosts", name) for name in hosts)]
        for setting, name in [*opened, *(("web.proxies", name) for name in proxies)]:
            if setting == "web.proxies" or not is_loopback(name):
                raise UnusableSettings(
                    f"{setting} is {name!r}, and everybody who reaches it could move the arm, because auth.mode is "
                    f"none, which is for this machine alone; {WAY_OUT}, or leave {setting} out"
                )
    elif mode == "proxy" and not (is_loopback(host) and proxies):
        raise UnusableSettings(
            f"auth.mode is proxy, which believes whoever reaches {host!r}: let web.host be loopback, where the proxy "
            "alone brings others, and name the proxy in web.proxies"
        )
    elif host in ("0.0.0.0", "::", "") and not hosts:
        raise UnusableSettings(
            f"web.host {host!r} listens on every interface, and web.hosts names none under which this station is "
            'reached: every request would be refused; name them, e.g. web.hosts = ["robot.lab.example", "10.0.0.7"]'
        )
