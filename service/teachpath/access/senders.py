"""Who sends, by its address alone."""

from __future__ import annotations

from ipaddress import IPv6Address, ip_address
from typing import Final

NETWORK_BITS: Final = 64  # of an IPv6 address, by which one machine has as many addresses as it likes


def sender_of(address: str) -> str:
    """Return by which text a sender is counted: its address; of IPv6 its network, where it is no IPv4 in disguise."""
    try:
        number = ip_address(address)
    except ValueError:
        return address
    if isinstance(number, IPv6Address):
        number = number.ipv4_mapped or IPv6Address(int(number) >> NETWORK_BITS << NETWORK_BITS)
    return str(number)
