"""Who did what at a station, from where, and how it was answered: the entries of its audit log."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class AuditEntry:
    """One entry of the audit log.

    Attributes:
        number: in the log, from 1.
        at_ns: when it was written [ns since the Unix epoch].
        who: did it, as the station knows it.
        source: address or place from which it came: an IP address, `executor`, `command line`.
        action: that was asked for.
        answer: how it was answered.
        previous: hash of the entry before.
        hash: of all that stands above (SHA-256, hex).
    """

    number: int
    at_ns: int
    who: str
    source: str
    action: str
    answer: str
    previous: str
    hash: str
