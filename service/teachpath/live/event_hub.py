"""The event hub: publishes changes and states to all subscribers, as small documents with a sequence number.

An event says that a resource has changed (`topic` and `id`, named as in the REST API), or it carries a state that
changes many times a second (`now`). A subscriber that falls behind gets one event that asks it to read everything anew.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from functools import cached_property
from typing import Any, Final

Document = dict[str, Any]
Key = tuple[str, str]
RESYNC_TOPIC: Final = "all"  # of the first event, and of the one after an overflow: read everything anew
PRIVATE_TOPICS: Final = frozenset({"access_tokens", "people", "sessions"})  # a session's id is its secret's hash
MAX_PENDING_CHANGES: Final = 256  # changed resources that wait for one subscriber


class Event:
    """One event, the same object for every subscriber."""

    def __init__(self, document: Document) -> None:
        self.document: Document = document

    @cached_property
    def text(self) -> str:
        """Its JSON, encoded once for all subscribers."""
        return json.dumps(self.document, separators=(",", ":"), allow_nan=False, default=str)


class Subscriber:
    """The events that one subscriber has not received yet: of each topic and id, the newest."""

    def __init__(self, wake: Callable[[], None], first: Event, states: dict[Key, Event]) -> None:
        self.wake: Callable[[], None] = wake
        self._lock = threading.Lock()
        self._changes: dict[Key, Event] = {(RESYNC_TOPIC, ""): first}
        self._states = dict(states)

    def pop(self) -> Event | None:
        """Remove and return the oldest event, changes of resources before states; None: none waits."""
        with self._lock:
            for pending in (self._changes, self._states):
                for key in pending:
                    return pending.pop(key)
        return None

    @property
    def pending(self) -> int:
        """How many events wait."""
        with self._lock:
            return len(self._changes) + len(self._states)

    def _add(self, key: Key, event: Event, max_pending: int) -> None:
        with self._lock:
            pending = self._states if "now" in event.document else self._changes
            pending.pop(key, None)
            if (RESYNC_TOPIC, "") in self._changes and pending is self._changes:
                return  # the subscriber will read everything after this change
            pending[key] = event
            if len(self._changes) > max_pending:
                resync = _resync(event.document["sequence"], "too much has changed to tell it one by one")
                self._changes = {(RESYNC_TOPIC, ""): resync}


class EventHub:
    """Publishes to every subscriber; safe to use from several threads, and never blocks.

    Args:
        max_pending: changed resources that may wait for one subscriber.
    """

    def __init__(self, *, max_pending: int = MAX_PENDING_CHANGES) -> None:
        self._lock = threading.Lock()
        self._max_pending = max_pending
        self._sequence = 0
        self._subscribers: set[Subscriber] = set()
        self._states: dict[Key, Event] = {}

    def subscribe(self, wake: Callable[[], None]) -> Subscriber:
        """Add a subscriber; `wake()` is called, from any thread, when an event waits for it.

        Its first event asks it to read everything; then come all states.
        """
        with self._lock:
            subscriber = Subscriber(wake, _resync(self._sequence, "connected"), self._states)
            self._subscribers.add(subscriber)
        return subscriber

    def unsubscribe(self, subscriber: Subscriber) -> None:
        """Forget a subscriber."""
        with self._lock:
            self._subscribers.discard(subscriber)

    def publish_change(self, topic: str, key: str, status: Document | None = None) -> None:
        """Publish that a resource has changed, and how it stands; of who signs in, nobody hears."""
        if topic not in PRIVATE_TOPICS:
            self._publish((topic, key), {"status": status} if status else {})

    def publish_state(self, topic: str, key: str, now: Document | None) -> None:
        """Publish the state `now` of a thing, to later subscribers too; None: it has gone."""
        self._publish((topic, key), {"now": now})

    def _publish(self, key: Key, content: Document) -> None:
        with self._lock:
            self._sequence += 1
            event = Event({"sequence": self._sequence, "topic": key[0], "id": key[1], **content})
            if content.get("now") is not None:
                self._states[key] = event
            elif "now" in content:
                self._states.pop(key, None)
            subscribers = list(self._subscribers)
            for subscriber in subscribers:
                subscriber._add(key, event, self._max_pending)
        for subscriber in subscribers:
            subscriber.wake()


def _resync(sequence: int, reason: str) -> Event:
    return Event({"sequence": sequence, "topic": RESYNC_TOPIC, "id": "", "reason": reason})
