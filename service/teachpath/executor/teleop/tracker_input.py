"""The newest sample of a tracker, taken from the one session that the tracker's name belongs to."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Final

from teachpath.io.bus import Bus
from teachpath_proto.keys import Keys

STRANGER_TIMEOUT_NS: Final = 1_000_000_000  # [ns] after its last sample another session counts as gone


class TrackerInput:
    """Keeps the newest sample, and notices other sessions that send under the same name.

    Args:
        session: whose samples count; empty: those of the session that sends first. Samples that name none do not, for
            anybody could send them.
        clock: returns monotonic nanoseconds.
    """

    def __init__(self, bus: Bus, keys: Keys, tracker: str, session: str, clock: Callable[[], int]) -> None:
        self._session: str | None = session or None
        self._clock = clock
        self._newest: deque[tuple[int, bytes]] = deque(maxlen=1)
        self._stranger_ns = -STRANGER_TIMEOUT_NS  # of the clock, when another session has sent last
        self._anonymous_ns = -STRANGER_TIMEOUT_NS  # of the clock, when a sample that names no session has come last
        self._handle = bus.subscribe_with_source(keys.samples(tracker), self._receive)

    def pop(self) -> tuple[int, bytes] | None:
        """Return when the newest sample came, and its payload; None when no other has come."""
        return self._newest.pop() if self._newest else None

    def has_stranger(self, now: int) -> bool:
        """Tell whether another session sends under the tracker's name at `now` [ns of the clock]."""
        return now - self._stranger_ns < STRANGER_TIMEOUT_NS

    def has_anonymous(self, now: int) -> bool:
        """Tell whether samples that name no session come under the tracker's name at `now` [ns of the clock]."""
        return now - self._anonymous_ns < STRANGER_TIMEOUT_NS

    def close(self) -> None:
        """Stop listening."""
        self._handle.close()

    def _receive(self, _: str, payload: bytes, source: str) -> None:
        if not source:
            self._anonymous_ns = self._clock()
            return
        if self._session is None:
            self._session = source
        if source == self._session:
            self._newest.append((self._clock(), payload))
        else:
            self._stranger_ns = self._clock()
