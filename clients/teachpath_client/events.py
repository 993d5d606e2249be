"""The events of a station: a WebSocket that tells what has changed, so that nobody has to ask in a loop."""

from __future__ import annotations

import json
from collections.abc import Coroutine, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from threading import Thread
from typing import TYPE_CHECKING, Any, Self, TypeVar

from teachpath_client.errors import Unreachable
from teachpath_client.structuring import structured
from teachpath_proto.authorities import trusted_authorities

if TYPE_CHECKING:  # loaded when somebody listens: the command line imports this module
    from asyncio import AbstractEventLoop

    from websockets.asyncio.client import ClientConnection

T = TypeVar("T")


@dataclass(frozen=True)
class Event:
    """A change at the station.

    Attributes:
        sequence: counts up by one for each change.
        topic: a resource of the REST API (tasks, demonstrations, runs, paths, plans, jobs, executions), or station,
            executor, trackers, recordings, guidance; `all`: anything may have changed.
        id: of the resource; empty: of the whole topic.
        now: how it stands, where the event says so.
        status: of a job its task, kind, state, fraction, message and outcome; of an execution plan, state and reason.
        reason: of an event of topic `all`.
    """

    sequence: int
    topic: str
    id: str
    now: Any = None
    reason: str = ""
    status: dict[str, Any] | None = None


class Events:
    """The events from now on; use it as a context manager, and iterate over it.

    The first event is of topic `all`. The WebSocket is read and written on one thread of its own, because a connection
    by TLS is not safe on two.

    Args:
        url: of the station.
        token: that says who you are, where the station asks.

    Raises:
        Unreachable: no station answers, it has gone, or it does not let you look.
    """

    def __init__(self, url: str, *, token: str = "") -> None:
        self._headers = {"Authorization": f"Bearer {token}"} if token else {}
        self._trusted = trusted_authorities(url)
        self._address = f"ws{url.removeprefix('http').rstrip('/')}/api/v1/events"
        self._stack = ExitStack()
        self._loop: AbstractEventLoop
        self._socket: ClientConnection

    def __enter__(self) -> Self:
        import asyncio

        from websockets.exceptions import WebSocketException

        self._loop = asyncio.new_event_loop()
        thread = Thread(target=self._loop.run_forever, name="events", daemon=True)
        thread.start()
        self._stack.callback(self._loop.close)
        self._stack.callback(thread.join)
        self._stack.callback(self._loop.call_soon_threadsafe, self._loop.stop)
        try:
            self._socket = self._await(self._connect())
        except (OSError, WebSocketException) as error:
            self._stack.close()
            raise Unreachable(f"no events from {self._address} ({error}); start it with: teachpath serve") from None
        self._stack.callback(lambda: self._await(self._socket.close()))
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def __iter__(self) -> Iterator[Event]:
        while True:
            event = self.next(None)
            if event is not None:
                yield event

    def next(self, timeout: float | None) -> Event | None:
        """Return the next event; None when there is none within `timeout` [s]."""
        import asyncio

        from websockets.exceptions import WebSocketException

        try:
            return structured(Event, json.loads(self._await(asyncio.wait_for(self._socket.recv(), timeout))))
        except TimeoutError:
            return None
        except WebSocketException as error:
            raise Unreachable(f"the station at {self._address} has gone ({error})") from None

    async def _connect(self) -> ClientConnection:
        from websockets.asyncio.client import connect

        return await connect(self._address, proxy=None, additional_headers=self._headers, ssl=self._trusted)

    def _await(self, work: Coroutine[Any, Any, T]) -> T:
        """Return what comes of work on the thread of the WebSocket."""
        import asyncio

        return asyncio.run_coroutine_threadsafe(work, self._loop).result()
