"""Middleware: refuses commands of other origins, bodies too large or too slow, and answers when the service ends."""

from __future__ import annotations

import asyncio
import re
from typing import Final

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from teachpath.api.problems import REFUSED_KIND, refuse
from teachpath.api.sockets import same_origin
from teachpath.web.settings import WebSettings

MAX_DOCUMENT_SIZE: Final = 1024 * 1024  # bytes of a request that is no upload
MIN_UPLOAD_RATE: Final = 1000.0  # [bytes/s] of a body, after the time that every request has
SAFE_METHODS: Final = ("GET", "HEAD", "OPTIONS")
STOP: Final = re.compile(r"/api/v1/(executions/[^/]+/)?stop")  # never refused for what else is asked for
UPLOADS: Final = ("/demonstrations", "/uploads", "/meshes")  # ends of the paths that take whole files


class RequestLimits:
    """Refuses a request that a page of another origin sent, or whose body is over the limit or comes too slowly.

    Browsers send simple requests across origins without asking; their Origin header tells them apart.

    Args:
        app: receives what is not refused.
        settings: `largest_upload` is for a body sent to one of `UPLOADS`; all others are documents.
    """

    def __init__(self, app: ASGIApp, *, settings: WebSettings) -> None:
        self._app, self._settings = app, settings

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer 403, 408 or 413."""
        if scope["type"] != "http" or scope["method"] in SAFE_METHODS:
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        limit = self._settings.largest_upload if scope["path"].endswith(UPLOADS) else MAX_DOCUMENT_SIZE
        announced = headers.get("content-length", "0")
        if not same_origin(headers):
            sentence = f"a page of {headers['origin']} may not give orders here; use the station's own address"
            await _refuse(403, sentence)(scope, receive, send)
        elif not announced.isascii() or not announced.isdigit() or int(announced[:20]) > limit:
            await _refuse(413, _too_large(announced, limit))(scope, receive, send)
        else:
            await self._app(scope, _LimitedBody(receive, limit, self._settings.request_timeout), send)


class HeadRequests:
    """Answers HEAD as GET, without the body."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on."""
        if scope["type"] != "http" or scope["method"] != "HEAD":
            await self._app(scope, receive, send)
            return

        async def send_head(message: Message) -> None:
            await send({**message, "body": b""} if message["type"] == "http.response.body" else message)

        await self._app({**scope, "method": "GET"}, receive, send_head)


class AnswersAtTheEnd:
    """Answers 503 where the service ends before a request has its answer; what has begun is cut off.

    Args:
        app: is told to give up (cancelled) when the time for the service's end is over.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on."""
        begun = False

        async def noted(message: Message) -> None:
            nonlocal begun
            begun = True
            await send(message)

        try:
            await self._app(scope, receive, noted)
        except asyncio.CancelledError:
            if begun or scope["type"] != "http":
                raise
            await _refuse(503, "the service ends; ask again when it runs")(scope, receive, send)


def is_stop(scope: Scope) -> bool:
    """Tell whether a request stops the arm."""
    return scope["type"] == "http" and scope["method"] == "POST" and STOP.fullmatch(scope["path"]) is not None


class _LimitedBody:
    """Counts the bytes of a body while they are received, and the time that is waited for them."""

    def __init__(self, receive: Receive, limit: int, timeout: float) -> None:
        self._receive, self._limit, self._timeout = receive, limit, timeout
        self._count, self._waited, self._more = 0, 0.0, True

    async def __call__(self) -> Message:
        loop = asyncio.get_running_loop()
        start, allowed = loop.time(), self._timeout + self._count / MIN_UPLOAD_RATE
        try:
            async with asyncio.timeout(allowed - self._waited if self._more else None):
                message = await self._receive()
        except TimeoutError:
            raise HTTPException(408, _too_slow(self._count, allowed), headers={"Connection": "close"}) from None
        self._waited += loop.time() - start
        self._count += len(message.get("body", b""))
        self._more = message.get("more_body", False)
        if self._count > self._limit:
            raise HTTPException(413, _too_large(f"over {self._limit}", self._limit))
        return message


def _too_slow(count: int, allowed: float) -> str:
    return (
        f"{count} bytes of the body came within {allowed:g} s; it may take web.request_timeout, and a second for every "
        f"{MIN_UPLOAD_RATE:g} bytes; send it over a faster line, or use: teachpath import"
    )


def _too_large(count: str, limit: int) -> str:
    return f"a body of {count[:20]} bytes is over the limit of {limit}; split the file, or use: teachpath import"


def _refuse(status: int, sentence: str) -> Response:
    return refuse(status, sentence, REFUSED_KIND)
