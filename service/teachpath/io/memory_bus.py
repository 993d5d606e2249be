"""The bus within one process, the twin of the Zenoh bus: it delivers in the thread of the publisher, in order."""

from __future__ import annotations

import re
import threading
from collections import deque
from typing import Final

from teachpath.errors import Unreachable
from teachpath.io.bus import Answer, Changed, Handle, Missed, Receive, ReceiveWithSource
from teachpath.io.bus_delivery import WAITS, Delivery
from teachpath.io.declaration import Declaration

CACHE_SIZE: Final = 1024  # payloads of each key, as a client's publisher keeps them
THIS_PROCESS: Final = "this process"  # who publishes, unless somebody else is named


class MemoryBus:
    """The bus within one process: delivers in the publisher's thread, in order."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._receivers: dict[Declaration, tuple[re.Pattern[str], ReceiveWithSource]] = {}
        self._answers: dict[str, Answer] = {}
        self._tokens: list[str] = []
        self._caches: dict[str, deque[bytes]] = {}
        self._watchers: dict[Declaration, tuple[re.Pattern[str], Changed]] = {}

    def publish(self, key: str, payload: bytes, *, source: str | None = None, delivery: Delivery = WAITS) -> None:
        """Call the receivers of `key` in this thread, in the order of their subscriptions, as from `source`.

        Nothing is ever full here, so `delivery` makes no difference.
        """
        with self._lock:
            self._caches.setdefault(key, deque(maxlen=CACHE_SIZE)).append(payload)
            receivers = [receive for pattern, receive in self._receivers.values() if pattern.fullmatch(key)]
        for receive in receivers:
            receive(key, payload, THIS_PROCESS if source is None else source)

    def subscribe(self, key: str, receive: Receive) -> Handle:
        """Call `receive(key, payload)` for all that is published on keys matching `key` (`*` one segment, `**` any)."""
        return self.subscribe_with_source(key, lambda key, payload, _: receive(key, payload))

    def subscribe_with_source(self, key: str, receive: ReceiveWithSource, *, missed: Missed | None = None) -> Handle:
        """Call `receive(key, payload, source)` likewise; nothing is ever missed here, so `missed` is not called."""
        handle = Declaration(lambda: self._receivers.pop(handle, None))
        with self._lock:
            self._receivers[handle] = (_pattern(key), receive)
        return handle

    def history(self, key: str) -> list[bytes]:
        """Return the newest payloads on `key`, the oldest first: every publisher here keeps them."""
        with self._lock:
            return list(self._caches.get(key, ()))

    def serve(self, key: str, answer: Answer) -> Handle:
        """Answer queries on `key`, in the thread that asks; a second answer replaces the first."""
        self._answers[key] = answer
        return Declaration(lambda: self._answers.pop(key, None))

    def ask(self, key: str, payload: bytes = b"", *, timeout: float = 10.0) -> bytes:
        """Query `key` and return the answer.

        Raises:
            Unreachable: nobody serves the key; `timeout` [s] is not waited for.
            TeachpathError: the one that the answering side raised.
        """
        answer = self._answers.get(key)
        if answer is None:
            raise Unreachable(f"nobody answered {key} within {timeout:g} s; is that part of the service running?")
        return answer(payload)

    def announce(self, key: str) -> Handle:
        """Show that a part is alive under `key` until the handle is closed."""
        self._tokens.append(key)
        self._notify(key, True)

        def withdraw() -> None:
            self._tokens.remove(key)
            self._notify(key, False)

        return Declaration(withdraw)

    def watch(self, key: str, changed: Changed) -> Handle:
        """Call `changed(key, alive)` when a part under `key` comes or goes; parts already there come first."""
        handle = Declaration(lambda: self._watchers.pop(handle, None))
        pattern = _pattern(key)
        self._watchers[handle] = (pattern, changed)
        for token in self._tokens:
            if pattern.fullmatch(token):
                changed(token, True)
        return handle

    def is_joined(self) -> bool:
        """All are in this process."""
        return True

    def close(self) -> None:
        """Take back every subscription, answer and watch."""
        self._receivers.clear()
        self._answers.clear()
        self._watchers.clear()

    def _notify(self, key: str, alive: bool) -> None:
        for pattern, changed in list(self._watchers.values()):
            if pattern.fullmatch(key):
                changed(key, alive)


def _pattern(key: str) -> re.Pattern[str]:
    """Compile a Zenoh key expression: `**` is any number of segments, `*` is one."""
    segments = [".*" if s == "**" else re.escape(s).replace(r"\*", "[^/]*") for s in key.split("/")]
    return re.compile("/".join(segments).replace("/.*", "(?:/.*)?"))
