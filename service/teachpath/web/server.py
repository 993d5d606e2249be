"""The server of the web port: uvicorn, within limits."""

from __future__ import annotations

import resource
import socket
from functools import partial
from typing import Any, Final

import uvicorn

from teachpath.web.connections import ConnectionLimits, LimitedProtocol, LimitedWebSocket
from teachpath.web.settings import WebSettings

OTHER_FILES: Final = 256  # that the service has open beside its connections: recordings, database, bus, processes

ACCEPTS_A_ROUND: Final = (
    8  # connections that the event loop accepts, of about 0.3 ms each, before it looks for requests
)
BACKLOG: Final = 2048  # connections that wait in the system to be accepted


class _Server(uvicorn.Server):
    """A server that accepts few connections at a time, however many come.

    asyncio has one number for both: how many may wait in the system, and how many are accepted in one round.
    """

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        for listener in sockets or ():
            listener.listen(BACKLOG)


def web_server(application: Any, settings: WebSettings) -> uvicorn.Server:
    """Return a server of an ASGI application, to be run on a thread with a listening socket.

    Messages of WebSockets are not compressed: compressing an event for 200 pages costs more time than sending it, and
    a request waits for it.
    """
    limits = ConnectionLimits(settings.request_timeout, allow_connections(settings.max_connections))
    config = uvicorn.Config(
        application,
        http=partial(LimitedProtocol, limits),  # type: ignore[arg-type]  # it is called, whatever it is
        ws=partial(LimitedWebSocket, limits),  # type: ignore[arg-type]
        ws_per_message_deflate=False,
        backlog=ACCEPTS_A_ROUND,
        log_level="warning",
        access_log=False,
        timeout_graceful_shutdown=1,
    )
    return _Server(config)


def allow_connections(count: int) -> int:
    """Let this process have so many connections open, where the system allows it; return how many it may have."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft < count + OTHER_FILES and soft != resource.RLIM_INFINITY:
        soft = count + OTHER_FILES if hard == resource.RLIM_INFINITY else min(hard, count + OTHER_FILES)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
        return max(soft - OTHER_FILES, 1)
    return count
