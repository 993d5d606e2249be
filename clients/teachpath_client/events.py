"""The events of a station: a WebSocket that tells what has changed, so that nobody has to ask in a loop."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

from teachpath_client.errors import Unreachable
from teachpath_client.structuring import structured
from teachpath_proto.authorities import trusted_authorities

if TYPE_CHECKING:  # loaded when somebody listens: the command line imports this module
    from websockets.sync.client import ClientConnection


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

    The first event is of topic `all`.

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
        self._socket: ClientConnection

    def __enter__(self) -> Self:
        from websockets.exceptions import WebSocketException
        from websockets.sync.client import connect

        try:
            self._socket = self._stack.enter_context(
                connect(self._address, proxy=None, additional_headers=self._headers, ssl=self._trusted)
            )
        except (OSError, WebSocketException) as error:
            raise Unreachable(f"no events from {self._address} ({error}); start it with: teachpath serve") from None
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
        from websockets.exceptions import WebSocketException

        try:
            return structured(Event, json.loads(self._socket.recv(timeout)))
        except TimeoutError:
            return None
        except WebSocketException as error:
            raise Unreachable(f"the station at {self._address} has gone ({error})") from None
