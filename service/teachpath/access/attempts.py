"""Failed sign-ins: after some of one name or from one address, none is tried for a while."""

from __future__ import annotations

import threading
from collections import OrderedDict, deque
from collections.abc import Callable
from typing import Final

from teachpath.access.senders import sender_of
from teachpath.errors import TooManyAttempts

WINDOW: Final = 300.0  # [s] in which failures are counted
MAX_OF_NAME: Final = 10  # failures of one name from one address
MAX_FROM_ADDRESS: Final = 50  # failures from one address
MAX_KEYS: Final = 10_000  # names and addresses that are remembered; beyond, the oldest is forgotten


class Attempts:
    """Counts failed sign-ins by name and address; safe to use from several threads.

    Args:
        clock: the time [s].
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._failures: OrderedDict[tuple[str, str], deque[float]] = OrderedDict()
        self._lock = threading.Lock()

    def begin(self, name: str, address: str) -> None:
        """Count an attempt as failed until `succeed`, so that many at a time are no way around the limit.

        Raises:
            TooManyAttempts: there were too many; it says for how long none is tried.
        """
        now = self._clock()
        with self._lock:
            for key, limit in _keys(name, address):
                failures = self._recent(key, now)
                if len(failures) >= limit:
                    wait = failures[-limit] + WINDOW - now
                    raise TooManyAttempts(
                        f"{len(failures)} sign-ins failed within {WINDOW:g} s, the limit; try again in {wait:.0f} s",
                        wait,
                    )
            for key, _ in _keys(name, address):
                self._recent(key, now).append(now)

    def succeed(self, name: str, address: str) -> None:
        """Forget the failures of a name from an address: somebody has signed in, who only mistyped."""
        with self._lock:
            mine, everybodys = (key for key, _ in _keys(name, address))
            self._failures.pop(mine, None)
            if failures := self._failures.get(everybodys):
                failures.pop()

    def _recent(self, key: tuple[str, str], now: float) -> deque[float]:
        failures = self._failures.setdefault(key, deque())
        self._failures.move_to_end(key)
        while failures and failures[0] <= now - WINDOW:
            failures.popleft()
        while len(self._failures) > MAX_KEYS:
            self._failures.popitem(last=False)
        return failures


def _keys(name: str, address: str) -> tuple[tuple[tuple[str, str], int], ...]:
    sender = sender_of(address)
    return ((name, sender), MAX_OF_NAME), (("", sender), MAX_FROM_ADDRESS)
