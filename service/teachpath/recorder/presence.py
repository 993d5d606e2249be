"""Which trackers are there, by their liveliness tokens and by the samples that they send."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass

# [s] after its last sample a tracker counts as silent, and one without a liveliness token as gone. A page shows it
# within 1 s.
SILENCE_TIMEOUT = 0.8
MAX_TRACKERS = 1000  # a flood of names must not fill the memory


@dataclass(frozen=True, slots=True)
class Tracker:
    """A tracker that is there.

    Attributes:
        name: of the tracker in its keys.
        announced: whether by a liveliness token; a tracker without one only sends.
        silence: since its last sample [s]; negative: it has sent none.
    """

    name: str
    announced: bool
    silence: float

    @property
    def is_silent(self) -> bool:
        """Whether it has sent and does not any more: stopped, stuck, or its line is dead."""
        return self.silence > SILENCE_TIMEOUT


class Presence:
    """Follows which trackers come and go; safe to use from several threads."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock, self._lock = clock, threading.Lock()
        self._announced: set[str] = set()
        self._last_sample: dict[str, float] = {}

    def on_liveliness(self, tracker: str, alive: bool) -> None:
        """Take note that a tracker came or went."""
        with self._lock:
            if alive and len(self._announced) < MAX_TRACKERS:
                self._announced.add(tracker)
            elif not alive:
                self._announced.discard(tracker)
                self._last_sample.pop(tracker, None)

    def is_announced(self, tracker: str) -> bool:
        """Tell whether a tracker is there by a liveliness token."""
        with self._lock:
            return tracker in self._announced

    def on_sample(self, tracker: str) -> None:
        """Take note of a sample."""
        if tracker in self._last_sample:
            self._last_sample[tracker] = self._clock()
            return
        with self._lock:
            if len(self._last_sample) < MAX_TRACKERS:
                self._last_sample[tracker] = self._clock()
            else:
                limit = self._clock() - SILENCE_TIMEOUT
                self._last_sample = {name: at for name, at in self._last_sample.items() if at > limit}

    def silence_of(self, tracker: str) -> float:
        """Return the time since the last sample of a tracker [s]; 0 when none is known."""
        with self._lock:
            return self._clock() - self._last_sample.get(tracker, self._clock())

    def trackers(self) -> list[Tracker]:
        """Return the trackers that are there, by name."""
        now = self._clock()
        with self._lock:
            sending = {name for name, at in self._last_sample.items() if now - at <= SILENCE_TIMEOUT}
            return [
                Tracker(name, name in self._announced, round(now - self._last_sample.get(name, now + 1.0), 1))
                for name in sorted(self._announced | sending)
            ]
