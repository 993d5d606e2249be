"""The news: what has changed, told to everyone who listens, in small documents with a sequence number.

A piece of news says that a resource has changed (`topic` and `id`, named as in the REST API), or how something stands
now that changes many times a second (`now`). Whoever falls behind is told to read everything anew.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any, Final

Document = dict[str, Any]
Key = tuple[str, str]
ALL: Final = "all"  # the topic of the first piece, and of the one after an overflow: read everything anew
LONGEST: Final = 256  # changed resources that wait for one listener


class Subscriber:
    """One who listens: what it has not been told yet, the newest piece of each topic and id."""

    def __init__(self, wake: Callable[[], None], first: Document, standing: dict[Key, Document]) -> None:
        self.wake = wake
        self._lock = threading.Lock()
        self._changes: dict[Key, Document] = {(ALL, ""): first}
        self._standing = dict(standing)

    def take(self) -> Document | None:
        """Return the oldest piece that waits, changes of resources first, or None."""
        with self._lock:
            for waiting in (self._changes, self._standing):
                for key in waiting:
                    return waiting.pop(key)
        return None

    @property
    def waiting(self) -> int:
        """Number of pieces that wait."""
        with self._lock:
            return len(self._changes) + len(self._standing)

    def _add(self, key: Key, piece: Document, longest: int) -> None:
        with self._lock:
            waiting = self._standing if "now" in piece else self._changes
            waiting.pop(key, None)
            if (ALL, "") in self._changes and waiting is self._changes:
                return  # it will read everything after this change
            waiting[key] = piece
            if len(self._changes) > longest:
                self._changes = {(ALL, ""): _anew(piece["sequence"], "too much has changed to tell it one by one")}


class EventHub:
    """Tells every listener; safe to use from several threads, and never waits for anybody."""

    def __init__(self, *, longest: int = LONGEST) -> None:
        """Begin with nothing told; at most `longest` changed resources wait for one listener."""
        self._lock = threading.Lock()
        self._longest = longest
        self._sequence = 0
        self._listeners: set[Subscriber] = set()
        self._standing: dict[Key, Document] = {}

    def attach(self, wake: Callable[[], None]) -> Subscriber:
        """Add a listener; `wake()` is called, from any thread, when there is news for it.

        It is told first to read everything, then how all that stands which no resource holds.
        """
        with self._lock:
            listener = Subscriber(wake, _anew(self._sequence, "connected"), self._standing)
            self._listeners.add(listener)
        return listener

    def detach(self, listener: Subscriber) -> None:
        """Forget a listener."""
        with self._lock:
            self._listeners.discard(listener)

    def tell(self, topic: str, key: str) -> None:
        """Say that a resource has changed."""
        self._pass_on((topic, key), {})

    def stand(self, topic: str, key: str, now: Document | None) -> None:
        """Say how something stands now; None: it is gone. Whoever comes later is told as well."""
        self._pass_on((topic, key), {"now": now})

    def _pass_on(self, key: Key, content: Document) -> None:
        with self._lock:
            self._sequence += 1
            piece = {"sequence": self._sequence, "topic": key[0], "id": key[1], **content}
            if content.get("now") is not None:
                self._standing[key] = piece
            elif "now" in content:
                self._standing.pop(key, None)
            listeners = list(self._listeners)
            for listener in listeners:
                listener._add(key, piece, self._longest)
        for listener in listeners:
            listener.wake()


def _anew(sequence: int, reason: str) -> Document:
    return {"sequence": sequence, "topic": ALL, "id": "", "reason": reason}
