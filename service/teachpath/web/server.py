"""The server of the web port: uvicorn, within limits."""

from __future__ import annotations

import resource
import socket
import ssl
from collections.abc import Sequence
from functools import partial
from typing import Any, Final

import uvicorn

from teachpath.web.connections import ConnectionLimits, LimitedProtocol, LimitedWebSocket
from teachpath.web.forwarded import IDENTITY, ForwardedHeaders
from teachpath.web.settings import WebSettings
from teachpath.web.tls import TlsOrHttp

OTHER_FILES: Final = 256  # that the service has open beside its connections: recordings, database, bus, processes

ACCEPTS_A_ROUND: Final = (
    8  # connections that the event loop accepts, of about 0.3 ms each, before it looks for requests
)
BACKLOG: Final = 2048  # connections that wait in the system to be accepted


class _Server(uvicorn.Server):
    """A server that accepts few connections at a time, however many come.

    asyncio has one number for both: how many may wait in the system, and how many are accepted in one round.
    """

    def __init__(self, config: uvicorn.Config, limits: ConnectionLimits) -> None:
        super().__init__(config)
        self._limits = limits

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        for listener in sockets or ():
            listener.listen(BACKLOG)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        for connection in tuple(self._limits.undecided):  # uvicorn knows nothing of them
            connection.drop()
        await super().shutdown(sockets)


def web_server(
    application: Any,
    settings: WebSettings,
    context: ssl.SSLContext | None = None,
    *,
    identity: Sequence[str] = IDENTITY,
) -> uvicorn.Server:
    """Return a server of an ASGI application, to be run on a thread with a listening socket.

    With a context of TLS it speaks https, and http on the same port; the scheme of a request tells them apart.

    Messages of WebSockets are not compressed: compressing an event for 200 pages costs more time than sending it, and
    a request waits for it.

    The headers `identity`, of who a client is, are believed of `web.proxies` alone.
    """
    limits = ConnectionLimits(settings.request_timeout, allow_connections(settings.max_connections))
    protocol = partial(TlsOrHttp, context, limits) if context else partial(LimitedProtocol, limits)
    config = uvicorn.Config(
        ForwardedHeaders(application, settings.proxies, identity) if settings.proxies else application,
        http=protocol,  # type: ignore[arg-type]  # it is called, whatever it is
        ws=partial(LimitedWebSocket, limits),  # type: ignore[arg-type]
        ws_per_message_deflate=False,
        backlog=ACCEPTS_A_ROUND,
        proxy_headers=False,
        log_level="warning",
        access_log=False,
        timeout_graceful_shutdown=1,
    )
    return _Server(config, limits)


def allow_connections(count: int) -> int:
    """Let this process have so many connections open, where the system allows it; return how many it may have."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    possible = possible_connections(count)
    if soft < count + OTHER_FILES and soft != resource.RLIM_INFINITY:
        wanted = count + OTHER_FILES if hard == resource.RLIM_INFINITY else min(hard, count + OTHER_FILES)
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
    return possible


def possible_connections(count: int) -> int:
    """Return how many of so many connections the system would let this process have open."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if resource.RLIM_INFINITY in (soft, hard):
        return count
    return max(1, min(count, hard - OTHER_FILES))
