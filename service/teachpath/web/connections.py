"""Connections of the web port: one that sends its request slowly or reads no answer is closed, and there is a limit.

uvicorn times out a connection that is idle between two requests, and WebSockets by pings. What it waits for without
end is timed here: the head of a request, and a reader that takes nothing. Bodies are timed where they are received
(`teachpath.api.middleware`), because only there it is known whether the client or the disk is slow.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from http import HTTPStatus
from typing import Any, Protocol

from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol


class Waiting(Protocol):
    """A connection that has sent no whole head of a request yet."""

    def drop(self) -> None:
        """Close it at once."""


@dataclass(frozen=True)
class ConnectionLimits:
    """What the connections of one web port may take.

    Attributes:
        request_timeout: [s] for the head of a request, and for a reader that takes nothing of an answer.
        max_connections: that may be open at a time.
        waiting: connections that have sent no whole head of a request yet, oldest first.
        undecided: those of them that are neither HTTP nor TLS yet, or amid the handshake of TLS.
    """

    request_timeout: float
    max_connections: int
    waiting: dict[Waiting, None] = field(default_factory=dict)
    undecided: dict[Waiting, None] = field(default_factory=dict)

    def make_room(self, count: int) -> bool:
        """Close the oldest connection that waits when `count` of HTTP and the undecided ones are too many.

        Returns:
            Whether there is room now.
        """
        if count + len(self.undecided) <= self.max_connections:
            return True
        if self.waiting:
            next(iter(self.waiting)).drop()
            return True
        return False


class _ReaderTimeout:
    """Closes a connection whose reader takes nothing of what was sent; to be mixed into a protocol of uvicorn."""

    _limits: ConnectionLimits
    _reader_timer: asyncio.TimerHandle | None = None
    transport: asyncio.Transport

    def pause_writing(self) -> None:
        """Give a reader that takes nothing some time."""
        super().pause_writing()  # type: ignore[misc]
        self._reader_timer = asyncio.get_running_loop().call_later(self._limits.request_timeout, self.transport.abort)

    def resume_writing(self) -> None:
        """Go on, because the reader has taken what was sent."""
        super().resume_writing()  # type: ignore[misc]
        self._stop_reader_timer()

    def connection_lost(self, exc: Exception | None) -> None:
        """Time the reader no longer."""
        self._stop_reader_timer()
        super().connection_lost(exc)  # type: ignore[misc]

    def _stop_reader_timer(self) -> None:
        if self._reader_timer is not None:
            self._reader_timer.cancel()
            self._reader_timer = None


class LimitedWebSocket(_ReaderTimeout, WebSocketsSansIOProtocol):
    """A WebSocket whose page has to read what is sent; `given` is what uvicorn gives to a protocol."""

    def __init__(self, limits: ConnectionLimits, **given: Any) -> None:
        super().__init__(**given)
        self._limits = limits

    async def send(self, message: Any) -> None:
        """Send a message; one that was refused with a status needs no handshake, whose lack uvicorn would log."""
        await super().send(message)
        self.handshake_complete: bool = self.handshake_complete or self.close_sent


class LimitedProtocol(_ReaderTimeout, H11Protocol):
    """An HTTP connection within limits.

    Args:
        limits: of all connections of its port.
        on_made: called when the connection is made, before anything else.
        given: what uvicorn gives to a protocol.
    """

    def __init__(self, limits: ConnectionLimits, on_made: Callable[[], None] = lambda: None, **given: Any) -> None:
        super().__init__(**given)
        self._limits = limits
        self._on_made = on_made
        self._head_timer: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Wait for a request; close the oldest connection that waits for one when there are too many."""
        self._on_made()
        super().connection_made(transport)
        if self._limits.make_room(len(self.connections)):
            self._wait_for_head()
        else:
            self._refuse(
                503,
                f"{self._limits.max_connections} connections are open, the limit "
                "(web.max_connections); close some pages or programs, or raise the setting",
            )

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop waiting."""
        self._stop_waiting()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Pass on what came; the time for the head ends with the head."""
        super().data_received(data)
        if self._is_answering() or self.transport.get_protocol() is not self:  # a WebSocket has a protocol of its own
            self._stop_waiting()
        elif self._head_timer is None and not self.transport.is_closing():
            self._wait_for_head()

    def drop(self) -> None:
        """Close the connection at once, whatever has not been sent."""
        self._stop_waiting()
        self.transport.abort()

    def _is_answering(self) -> bool:
        return self.cycle is not None and not self.cycle.response_complete

    def _wait_for_head(self) -> None:
        self._limits.waiting[self] = None
        self._head_timer = self.loop.call_later(self._limits.request_timeout, self._time_out)

    def _stop_waiting(self) -> None:
        self._limits.waiting.pop(self, None)
        if self._head_timer is not None:
            self._head_timer.cancel()
            self._head_timer = None

    def _time_out(self) -> None:
        self._stop_waiting()
        self._refuse(
            408,
            f"the head of the request took over {self._limits.request_timeout:g} s, the limit "
            "(web.request_timeout); send it again",
        )

    def _refuse(self, status: int, sentence: str) -> None:
        """Answer a connection that has no request, and close it."""
        title = HTTPStatus(status).phrase
        problem = {"type": "about:blank", "title": title, "status": status, "detail": sentence, "error": "Refused"}
        body = json.dumps(problem).encode()
        head = (
            f"HTTP/1.1 {status} {title}\r\nContent-Type: application/problem+json\r\n"
            f"Content-Length: {len(body)}\r\nConnection: close\r\n\r\n"
        )
        self.transport.write(head.encode() + body)
        self.transport.close()
