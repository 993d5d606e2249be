"""Middleware of a station that does not ask who somebody is: it answers this machine alone."""

from __future__ import annotations

from typing import Final

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from teachpath.access.loopback import WAY_OUT, authority_of, host_of, is_loopback
from teachpath.api.problems import refuse

PROXY_HEADERS: Final = ("forwarded", "x-forwarded-", "x-real-ip", "via")  # beginnings of the headers of proxies


class LoopbackOnly:
    """Refuses what does not stay on this machine: by either end of the connection, by Host, Origin or a proxy."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer 403."""
        if scope["type"] in ("http", "websocket") and (fault := _fault(scope)):
            sentence = f"{fault}, and this station answers its own machine alone, because auth.mode is none; {WAY_OUT}"
            await refuse(403, sentence, "NotAllowed")(scope, receive, send)
        else:
            await self._app(scope, receive, send)


def _fault(scope: Scope) -> str:
    headers = Headers(scope=scope)
    for end in ("client", "server"):
        address = scope.get(end)
        if address is None or not is_loopback(address[0]):
            return f"the {end} of this connection is {address[0] if address else 'unknown'}"
    for authority in headers.getlist("host"):
        if not is_loopback(host_of(authority)):
            return f"the header Host is {authority[:80]!r}"
    for origin in headers.getlist("origin"):
        if not is_loopback(host_of(authority_of(origin))):
            return f"a page of {origin[:80]!r} asks"
    passed = next((name for name in headers if name.startswith(PROXY_HEADERS)), "")
    return f"a proxy has passed this on (header {passed})" if passed else ""
