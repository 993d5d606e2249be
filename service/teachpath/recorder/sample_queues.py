"""Queues of received samples: the transport's threads append to them, the recording thread takes out.

Only recorded trackers have queues, and each queue is of limited length, so that neither a flood nor a crowd of
unrecorded trackers costs memory or keeps others waiting.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from teachpath.recorder.presence import Presence
from teachpath_proto.keys import Keys, is_name, name_refusal


class QueueItem(NamedTuple):
    """One payload and its receive time; a payload of None says that the tracker has gone."""

    payload: bytes | None
    receive_ns: int


class _Queue:
    __slots__ = ("dropped", "items")

    def __init__(self) -> None:
        self.items: deque[QueueItem] = deque()
        self.dropped = 0


class SampleQueues:
    """One queue for each tracker that is recorded.

    Args:
        max_length: samples that one queue may hold; further ones are dropped, and counted.
    """

    def __init__(self, keys: Keys, presence: Presence, max_length: int) -> None:
        self._keys = keys
        self._presence = presence
        self.max_length: int = max_length
        self._queues: dict[str, _Queue] = {}  # by the key of the samples
        self._invalid_name_count = 0
        self._last_invalid_name = ""

    # on the transport's threads: append only

    def on_sample(self, key: str, payload: bytes) -> None:
        """Take a payload from the bus."""
        queue = self._queues.get(key)
        if queue is None:
            self._on_unrecorded_sample(self._keys.tracker_of(key))
        elif len(queue.items) < self.max_length:
            queue.items.append(QueueItem(payload, time.time_ns()))
        else:
            queue.dropped += 1

    def on_liveliness(self, key: str, alive: bool) -> None:
        """Take note that a tracker came or went; samples that it sent before are recorded before."""
        tracker = self._keys.announced(key)
        if not is_name(tracker):
            self._count_invalid_name(tracker)
            return
        self._presence.on_liveliness(tracker, alive)
        queue = self._queues.get(self._keys.samples(tracker))
        if queue is not None and not alive:
            queue.items.append(QueueItem(None, 0))

    def _on_unrecorded_sample(self, tracker: str) -> None:
        if is_name(tracker):
            self._presence.on_sample(tracker)
        else:
            self._count_invalid_name(tracker)

    def _count_invalid_name(self, tracker: str) -> None:
        self._invalid_name_count += 1
        self._last_invalid_name = tracker

    # on the recording thread

    def open(self, tracker: str) -> None:
        """Queue the samples of `tracker` from now on."""
        self._queues[self._keys.samples(tracker)] = _Queue()

    def close(self, tracker: str) -> None:
        """Queue no more samples of `tracker`, and forget those in its queue."""
        self._queues.pop(self._keys.samples(tracker), None)

    def pop(self, tracker: str, limit: int) -> list[QueueItem]:
        """Remove and return up to `limit` items from the queue of `tracker`, the oldest first."""
        queue = self._queues.get(self._keys.samples(tracker))
        if queue is None:
            return []
        return [queue.items.popleft() for _ in range(min(limit, len(queue.items)))]

    def put_first(self, tracker: str, items: Sequence[QueueItem]) -> None:
        """Queue items of `tracker` before those that wait."""
        queue = self._queues.get(self._keys.samples(tracker))
        if queue is not None:
            queue.items.extendleft(reversed(items))

    def dropped(self, tracker: str) -> int:
        """Return how many samples of `tracker` were dropped since the last call."""
        queue = self._queues.get(self._keys.samples(tracker))
        if queue is None or not queue.dropped:
            return 0
        count, queue.dropped = queue.dropped, 0
        return count

    def is_empty(self, tracker: str) -> bool:
        """Tell whether no sample of `tracker` waits."""
        queue = self._queues.get(self._keys.samples(tracker))
        return queue is None or not queue.items

    def invalid_names(self) -> str:
        """Return a sentence about trackers whose names cannot be recorded, or nothing."""
        if not self._invalid_name_count:
            return ""
        return (
            f"{self._invalid_name_count} messages came from trackers whose names cannot be recorded; "
            f"{name_refusal('tracker', self._last_invalid_name)}"
        )

    @property
    def backlog(self) -> int:
        """How many samples wait in all queues."""
        return sum(len(queue.items) for queue in list(self._queues.values()))
