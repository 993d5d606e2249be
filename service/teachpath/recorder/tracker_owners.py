"""Which session on the bus each tracker's name belongs to: the one that sent first, until it is silent."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Final

from teachpath.errors import Conflict
from teachpath_proto.keys import Keys, anonymous_refusal

SILENCE_TIMEOUT: Final = 2.0  # [s] after its last sample a session owns its name no longer
REPORT_TIME: Final = 10.0  # [s] for which another session that sent under an owned name is reported
MAX_NAMES: Final = 1000  # a flood of names must not fill the memory


class TrackerOwners:
    """Follows who sends under which name; safe to use from several threads.

    Args:
        clock: [s] monotonic.
    """

    def __init__(self, keys: Keys, clock: Callable[[], float]) -> None:
        self._keys = keys
        self._clock = clock
        self._lock = threading.Lock()
        self._owners: dict[str, tuple[str, float]] = {}  # by the key of the samples: session, time of its last sample
        self._strangers: dict[str, float] = {}  # by the name: when a session that does not own it has sent last

    def owner(self, tracker: str) -> str:
        """Return the session that a tracker's name belongs to; empty when nobody sends under it, or does not say."""
        with self._lock:
            session, last = self._owners.get(self._keys.samples(tracker), ("", -SILENCE_TIMEOUT))
            return session if self._clock() - last < SILENCE_TIMEOUT else ""

    def require_named(self, tracker: str) -> None:
        """Raise Conflict where samples come under a tracker's name that name no session, so that nobody owns it."""
        with self._lock:
            session, last = self._owners.get(self._keys.samples(tracker), ("somebody", 0.0))
            if not session and self._clock() - last < SILENCE_TIMEOUT:
                raise Conflict(anonymous_refusal(tracker))

    def faults(self) -> list[str]:
        """Return which names several sessions send under, in sentences for the operator."""
        with self._lock:
            now = self._clock()
            self._strangers = {name: at for name, at in self._strangers.items() if now - at < REPORT_TIME}
            return [
                f"two sessions send samples as {name}, and the arm follows the first alone: end one, or rename it"
                for name in sorted(self._strangers)
            ]

    def on_sample(self, key: str, _: bytes, source: str) -> None:
        """Take note that a session sent a sample."""
        now = self._clock()
        with self._lock:
            owner, last = self._owners.get(key, (source, now))
            if source == owner or not owner or now - last > SILENCE_TIMEOUT:
                if key in self._owners or len(self._owners) < MAX_NAMES:
                    self._owners[key] = (source, now)
            else:
                self._strangers[self._keys.tracker_of(key)] = now
