"""Middleware: what one subject may ask for at a time, and connections that are kept for stops."""

from __future__ import annotations

from typing import Final

from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Receive, Scope, Send

from teachpath.access.access import Access
from teachpath.access.settings import LimitSettings
from teachpath.access.subject_limits import Kind, SubjectLimits, subject_name
from teachpath.api.access import identify
from teachpath.api.faults import answer_to
from teachpath.api.middleware import UPLOADS, is_stop
from teachpath.api.problems import REFUSED_KIND, refuse
from teachpath.errors import TooManyRequests

KEPT_SHARE: Final = 0.1  # of the connections, which requests and WebSockets leave to those that come: to stops


class LimitSubjects:
    """Refuses with 429 what a subject asks for beyond its limits; a stop is never counted and never refused.

    Where the station asks nobody who he is, all of its machine would be one subject, and a program would take from the
    page what is the page's: then only the limit of all connections holds.

    Args:
        app: receives what is not refused.
        access: tells who asks.
        settings: the limits of one subject.
        max_connections: that the web port may have open; requests and WebSockets together leave some of them free.
    """

    def __init__(self, app: ASGIApp, *, access: Access, settings: LimitSettings, max_connections: int) -> None:
        self._app, self._access = app, access
        self._limits = SubjectLimits(settings)
        self._most, self._open = max_connections - max(1, round(KEPT_SHARE * max_connections)), 0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer 429 or 503."""
        if scope["type"] not in ("http", "websocket") or is_stop(scope):
            await self._app(scope, receive, send)
            return
        if self._open >= self._most:
            sentence = (
                f"{self._open} requests and WebSockets are open, and the rest of web.max_connections is kept for those "
                "that stop the arm; close some pages or programs, or raise the setting"
            )
            await refuse(503, sentence, REFUSED_KIND, headers={"Retry-After": "1"})(scope, receive, send)
            return
        self._open += 1
        try:
            await self._pass_on(scope, receive, send)
        finally:
            self._open -= 1

    async def _pass_on(self, scope: Scope, receive: Receive, send: Send) -> None:
        if self._access.mode == "none":
            await self._app(scope, receive, send)
            return
        client = scope.get("client")
        name = subject_name(identify(HTTPConnection(scope), self._access), client[0] if client else "")
        kind = _kind(scope)
        try:
            self._limits.begin(name, kind)
        except TooManyRequests as error:
            await answer_to(error)(scope, receive, send)
            return
        try:
            await self._app(scope, receive, send)
        finally:
            self._limits.end(name, kind)


def _kind(scope: Scope) -> Kind:
    if scope["type"] == "websocket":
        return Kind.WEBSOCKET
    return Kind.UPLOAD if scope["method"] == "POST" and scope["path"].endswith(UPLOADS) else Kind.REQUEST
