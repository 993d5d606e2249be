"""What one subject may ask of a station at a time: a token, a person, or an address of which nobody is known."""

from __future__ import annotations

import time
from collections import Counter, OrderedDict
from collections.abc import Callable
from enum import StrEnum
from typing import Final

from teachpath.access.access import REFUSED_SUBJECT
from teachpath.access.senders import sender_of
from teachpath.access.settings import LimitSettings
from teachpath.errors import TooManyRequests
from teachpath.records import Subject

MAX_KNOWN: Final = 10_000  # subjects whose rate is remembered; beyond, the oldest is forgotten
RETRY_AFTER: Final = 1.0  # [s] after which something that is under way may have ended


class Kind(StrEnum):
    """What is held open for a subject."""

    REQUEST = "requests"
    UPLOAD = "uploads"
    WEBSOCKET = "WebSockets"


class SubjectLimits:
    """Counts what each subject asks for and holds open; used from one thread.

    The rate of requests is limited by the generic cell rate algorithm (ITU-T I.371), which remembers one time of each.

    Args:
        settings: the limits.
        clock: the time [s].
    """

    def __init__(self, settings: LimitSettings, clock: Callable[[], float] = time.monotonic) -> None:
        self._settings, self._clock = settings, clock
        self._due: OrderedDict[str, float] = OrderedDict()  # when a subject that kept to its rate would have sent all
        self._held: Counter[tuple[str, Kind]] = Counter()

    def begin(self, subject: str, kind: Kind) -> None:
        """Count a request of a subject as under way, or a WebSocket as open, until `end`.

        Raises:
            TooManyRequests: the subject has too many, or has sent too many of late.
        """
        self._require_rate(subject)
        limits = {
            Kind.REQUEST: ("max_requests", self._settings.max_requests),
            Kind.UPLOAD: ("max_uploads", self._settings.max_uploads),
            Kind.WEBSOCKET: ("max_websockets", self._settings.max_websockets),
        }
        setting, limit = limits[kind]
        if self._held[subject, kind] >= limit:
            raise TooManyRequests(
                f"{limit} {kind} of {subject} are open, the limit of one subject (limits.{setting}); wait until one "
                "has ended, close some pages or programs, or raise the setting",
                RETRY_AFTER,
            )
        self._held[subject, kind] += 1

    def end(self, subject: str, kind: Kind) -> None:
        """Count it no longer."""
        self._held[subject, kind] -= 1
        if not self._held[subject, kind]:
            del self._held[subject, kind]

    def _require_rate(self, subject: str) -> None:
        now, rate = self._clock(), self._settings.request_rate
        due = max(self._due.pop(subject, now), now) + 1 / rate
        wait = due - now - self._settings.request_burst / rate
        self._due[subject] = due if wait <= 0 else due - 1 / rate
        while len(self._due) > MAX_KNOWN:
            self._due.popitem(last=False)
        if wait > 0:
            raise TooManyRequests(
                f"{subject} has sent over {self._settings.request_burst} requests at once, and {rate:g} a second are "
                f"allowed then (limits.request_rate, limits.request_burst); go on in {wait:.3g} s",
                wait,
            )


def subject_name(subject: Subject, address: str) -> str:
    """Return by which name the limits of a subject are counted: its own, else its address."""
    if subject.name and subject is not REFUSED_SUBJECT:
        return subject.name
    return f"address {sender_of(address) or 'unknown'}"
