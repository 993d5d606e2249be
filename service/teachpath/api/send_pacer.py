"""The pace of WebSockets: what many of them have to send at a time is sent a few at a time.

One event for 200 pages takes the event loop tens of milliseconds, for which nothing else would be answered, a stop
neither. Here the loop looks for requests after every few messages.
"""

from __future__ import annotations

import asyncio
import threading
from contextlib import suppress
from itertools import islice
from typing import Final

from anyio.lowlevel import RunVar

SENDERS_A_ROUND: Final = 4  # woken in one round of the loop; each sends one message, of about 0.1 ms


class SendPacer:
    """Wakes the senders of one event loop in the order in which they asked for it, a few in each round of the loop."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._lock = threading.Lock()
        self._waiting: dict[asyncio.Event, None] = {}
        self._scheduled = False

    def wake(self, sender: asyncio.Event) -> None:
        """Set the event of a sender soon; from any thread, never blocks."""
        with self._lock:
            self._waiting[sender] = None
            if self._scheduled:
                return
            self._scheduled = True
        with suppress(RuntimeError):  # the loop has ended meanwhile
            self._loop.call_soon_threadsafe(self._wake_some)

    def _wake_some(self) -> None:
        with self._lock:
            senders = list(islice(self._waiting, SENDERS_A_ROUND))
            for sender in senders:
                del self._waiting[sender]
            self._scheduled = bool(self._waiting)
            if self._scheduled:
                self._loop.call_soon(self._wake_some)
        for sender in senders:
            sender.set()


_PACER: Final[RunVar[SendPacer]] = RunVar("send_pacer")


def pacer_of_running_loop() -> SendPacer:
    """Return the pacer of the loop that runs, one for all its sockets."""
    try:
        return _PACER.get()
    except LookupError:
        pacer = SendPacer(asyncio.get_running_loop())
        _PACER.set(pacer)
        return pacer
