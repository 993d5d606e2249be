"""What a proxy says of whom it asks for: believed of the proxies that the settings name alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

IDENTITY: Final = ("X-Forwarded-User", "X-Forwarded-Groups")  # headers of who a client is


class ForwardedHeaders:
    """Takes address and scheme of a client from a named proxy, and the client's name and groups from nobody else.

    Args:
        application: of ASGI, that is told.
        proxies: addresses and networks.
        identity: names of the headers that say who the client is.
    """

    def __init__(self, application: Any, proxies: Sequence[str], identity: Sequence[str]) -> None:
        self._identity = {name.lower().encode() for name in identity}
        self._believing = ProxyHeadersMiddleware(application, list(proxies))

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Pass a connection on."""
        client = scope.get("client")
        if "headers" in scope and not (client and client[0] in self._believing.trusted_hosts):
            kept = [(name, value) for name, value in scope["headers"] if name not in self._identity]
            scope = {**scope, "headers": kept}
        await self._believing(scope, receive, send)
