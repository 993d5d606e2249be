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


class QueueItem(NamedTuple):
    """One payload and when it came; None stands for the news that its tracker has gone."""

    payload: bytes | None
    receive_ns: int


class _Queue:
    __slots__ = ("dropped", "waiting")

    def __init__(self) -> None:
        self.waiting: deque[QueueItem] = deque()
        self.dropped = 0


class SampleQueues:
    """The lines of the trackers that are recorded.

    Args:
        longest: samples that may wait in one line; what comes on top of that is turned away, and counted.
    """

    def __init__(self, keys: Keys, presence: Presence, max_length: int) -> None:
        self._keys, self._presence, self.max_length = keys, presence, max_length
        self._queues: dict[str, _Queue] = {}  # by the key of the samples
        self._invalid_name_count = 0
        self._last_invalid_name = ""

    # on the transport's threads: append only

    def on_sample(self, key: str, payload: bytes) -> None:
        """Take a payload from the bus."""
        queue = self._queues.get(key)
        if queue is None:
            self._on_unrecorded_sample(self._keys.tracker_of(key))
        elif len(queue.waiting) < self.max_length:
            queue.waiting.append(QueueItem(payload, time.time_ns()))
        else:
            queue.dropped += 1

    def on_liveliness(self, key: str, alive: bool) -> None:
        """Take from the bus that a tracker came or went; what it sent before is recorded before."""
        tracker = self._keys.announced(key)
        if not is_name(tracker):
            self._invalid_name_count, self._last_invalid_name = self._invalid_name_count + 1, tracker
            return
        self._presence.on_liveliness(tracker, alive)
        queue = self._queues.get(self._keys.samples(tracker))
        if queue is not None and not alive:
            queue.waiting.append(QueueItem(None, 0))

    def _on_unrecorded_sample(self, tracker: str) -> None:
        if is_name(tracker):
            self._presence.on_sample(tracker)
        else:
            self._invalid_name_count, self._last_invalid_name = self._invalid_name_count + 1, tracker

    # on the recorder's

    def open(self, tracker: str) -> None:
        """Let the samples of `tracker` wait from now on."""
        self._queues[self._keys.samples(tracker)] = _Queue()

    def close(self, tracker: str) -> None:
        """Only hear `tracker` from now on."""
        self._queues.pop(self._keys.samples(tracker), None)

    def pop(self, tracker: str, limit: int) -> list[QueueItem]:
        """Take up to `most` from the line of `tracker`, in the order they came."""
        queue = self._queues.get(self._keys.samples(tracker))
        if queue is None:
            return []
        return [queue.waiting.popleft() for _ in range(min(limit, len(queue.waiting)))]

    def dropped(self, tracker: str) -> int:
        """Return how many samples of `tracker` were turned away since this was last asked."""
        queue = self._queues.get(self._keys.samples(tracker))
        if queue is None or not queue.dropped:
            return 0
        count, queue.dropped = queue.dropped, 0
        return count

    def is_empty(self, tracker: str) -> bool:
        """Tell whether nothing of `tracker` waits."""
        queue = self._queues.get(self._keys.samples(tracker))
        return queue is None or not queue.waiting

    def invalid_names(self) -> str:
        """Say who came under a name that cannot be recorded, or nothing."""
        if not self._invalid_name_count:
            return ""
        return (
            f"{self._invalid_name_count} messages came from trackers whose names cannot be recorded, the last of them "
            f"from {self._last_invalid_name[:80]!r}: use letters, digits, '.', '_' or '-', at most 64"
        )

    @property
    def backlog(self) -> int:
        """How many samples wait in all lines."""
        return sum(len(queue.waiting) for queue in list(self._queues.values()))
