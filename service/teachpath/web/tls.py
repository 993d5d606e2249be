"""TLS of the web port, which answers http on the same port, too: the first byte of a connection tells them apart."""

from __future__ import annotations

import asyncio
import ssl
from asyncio.sslproto import SSLProtocol
from typing import Any, Final

from teachpath.web.connections import ConnectionLimits, LimitedProtocol

HANDSHAKE: Final = 0x16  # first byte of TLS; no request of HTTP begins with it


class TlsOrHttp(asyncio.Protocol):
    """A connection that has sent nothing yet; it gives way to TLS with HTTP in it, or to HTTP.

    asyncio begins TLS on a connection from which nothing has been read (`loop.start_tls`), but the byte that decides
    has been read; so its protocol of TLS is set up here.

    Args:
        context: of the server.
        limits: of all connections of the port, by which those that wait here and in the handshake are closed.
        given: what uvicorn gives to a protocol.
    """

    def __init__(self, context: ssl.SSLContext, limits: ConnectionLimits, **given: Any) -> None:
        self._context, self._limits, self._given = context, limits, given
        self._transport: asyncio.Transport
        self._timer: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Wait for the first byte and the end of the handshake, for as long as for the head of a request."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        self._limits.undecided[self] = None
        if not self._limits.make_room(len(self._given["server_state"].connections)):
            self.drop()
            return
        self._limits.waiting[self] = None
        self._timer = asyncio.get_running_loop().call_later(self._limits.request_timeout, self.drop)

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop waiting."""
        self._stop_waiting()

    def data_received(self, data: bytes) -> None:
        """Give way to what the first byte says."""
        http = LimitedProtocol(self._limits, self._stop_waiting, **self._given)
        if data[0] == HANDSHAKE:
            self._begin_tls(http, data)
        else:
            self._transport.set_protocol(http)
            http.connection_made(self._transport)
            http.data_received(data)

    def drop(self) -> None:
        """Close the connection at once."""
        self._stop_waiting()
        self._transport.abort()

    def _begin_tls(self, http: LimitedProtocol, data: bytes) -> None:
        loop = asyncio.get_running_loop()
        ended = loop.create_future()
        ended.add_done_callback(self._on_handshake_end)
        timeout: Any = self._limits.request_timeout  # typeshed has whole seconds
        tls = SSLProtocol(loop, http, self._context, ended, server_side=True, ssl_handshake_timeout=timeout)
        self._transport.set_protocol(tls)
        tls.connection_made(self._transport)
        view = memoryview(data)
        while view:
            buffer = tls.get_buffer(len(view))
            count = min(len(buffer), len(view))
            buffer[:count] = view[:count]
            tls.buffer_updated(count)
            view = view[count:]

    def _on_handshake_end(self, ended: asyncio.Future[None]) -> None:
        ended.exception()  # it has been closed then, and nobody is to be told
        self._stop_waiting()

    def _stop_waiting(self) -> None:
        self._limits.waiting.pop(self, None)
        self._limits.undecided.pop(self, None)
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
