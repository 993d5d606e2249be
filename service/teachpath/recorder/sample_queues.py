"""What has been received and not yet recorded: the transport's threads append here, the recorder takes out.

A tracker that nobody records is only heard, and every other has a line of its own of limited length, so that neither
a flood nor a crowd of strangers costs memory or keeps others waiting.
"""

from __future__ import annotations

import time
from collections import deque
from typing import NamedTuple

from teachpath.recorder.presence import Presence
from teachpath_proto.keys import Keys, is_name


class Received(NamedTuple):
    """One payload and when it came; None stands for the news that its tracker has gone."""

    payload: bytes | None
    receive_ns: int


class _Line:
    __slots__ = ("turned_away", "waiting")

    def __init__(self) -> None:
        self.waiting: deque[Received] = deque()
        self.turned_away = 0


class Intake:
    """The lines of the trackers that are recorded.

    Args:
        longest: samples that may wait in one line; what comes on top of that is turned away, and counted.
    """

    def __init__(self, keys: Keys, presence: Presence, longest: int) -> None:
        self._keys, self._presence, self.longest = keys, presence, longest
        self._lines: dict[str, _Line] = {}  # by the key of the samples
        self._misnamed = 0
        self._misname = ""

    # on the transport's threads: append only

    def receive(self, key: str, payload: bytes) -> None:
        """Take a payload from the bus."""
        line = self._lines.get(key)
        if line is None:
            self._hear(self._keys.tracker_of(key))
        elif len(line.waiting) < self.longest:
            line.waiting.append(Received(payload, time.time_ns()))
        else:
            line.turned_away += 1

    def come_or_go(self, key: str, alive: bool) -> None:
        """Take from the bus that a tracker came or went; what it sent before is recorded before."""
        tracker = self._keys.announced(key)
        if not is_name(tracker):
            self._misnamed, self._misname = self._misnamed + 1, tracker
            return
        self._presence.announce(tracker, alive)
        line = self._lines.get(self._keys.samples(tracker))
        if line is not None and not alive:
            line.waiting.append(Received(None, 0))

    def _hear(self, tracker: str) -> None:
        if is_name(tracker):
            self._presence.hear(tracker)
        else:
            self._misnamed, self._misname = self._misnamed + 1, tracker

    # on the recorder's

    def open(self, tracker: str) -> None:
        """Let the samples of `tracker` wait from now on."""
        self._lines[self._keys.samples(tracker)] = _Line()

    def close(self, tracker: str) -> None:
        """Only hear `tracker` from now on."""
        self._lines.pop(self._keys.samples(tracker), None)

    def take(self, tracker: str, most: int) -> list[Received]:
        """Take up to `most` from the line of `tracker`, in the order they came."""
        line = self._lines.get(self._keys.samples(tracker))
        if line is None:
            return []
        return [line.waiting.popleft() for _ in range(min(most, len(line.waiting)))]

    def turned_away(self, tracker: str) -> int:
        """Return how many samples of `tracker` were turned away since this was last asked."""
        line = self._lines.get(self._keys.samples(tracker))
        if line is None or not line.turned_away:
            return 0
        count, line.turned_away = line.turned_away, 0
        return count

    def is_empty(self, tracker: str) -> bool:
        """Tell whether nothing of `tracker` waits."""
        line = self._lines.get(self._keys.samples(tracker))
        return line is None or not line.waiting

    def misnamed(self) -> str:
        """Say who came under a name that cannot be recorded, or nothing."""
        if not self._misnamed:
            return ""
        return (
            f"{self._misnamed} messages came from trackers whose names cannot be recorded, the last of them from "
            f"{self._misname[:80]!r}: use letters, digits, '.', '_' or '-', at most 64"
        )

    @property
    def backlog(self) -> int:
        """How many samples wait in all lines."""
        return sum(len(line.waiting) for line in list(self._lines.values()))
