"""Middleware: refuses commands from pages of another origin, and bodies that are too large."""

from __future__ import annotations

from typing import Final

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from teachpath.api.sockets import same_origin

MAX_DOCUMENT_SIZE: Final = 1024 * 1024  # bytes of a request that is no upload
SAFE_METHODS: Final = ("GET", "HEAD", "OPTIONS")


class RequestLimits:
    """Refuses a request that a page of another origin sent, or whose body is over the limit.

    Browsers send simple requests across origins without asking; their Origin header tells them apart.

    Args:
        app: receives what is not refused.
        largest_upload: bytes of a body sent to `.../demonstrations`; all others are documents.
    """

    def __init__(self, app: ASGIApp, *, largest_upload: int) -> None:
        self._app, self._largest_upload = app, largest_upload

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer 403 or 413."""
        if scope["type"] != "http" or scope["method"] in SAFE_METHODS:
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        limit = self._largest_upload if scope["path"].endswith("/demonstrations") else MAX_DOCUMENT_SIZE
        announced = headers.get("content-length", "0")
        if not same_origin(headers):
            sentence = f"a page of {headers['origin']} may not give orders here; use the station's own address"
            await _refuse(403, sentence)(scope, receive, send)
        elif not announced.isascii() or not announced.isdigit() or int(announced[:20]) > limit:
            await _refuse(413, _too_large(announced, limit))(scope, receive, send)
        else:
            await self._app(scope, _Counted(receive, limit), send)


class _Counted:
    """Counts the bytes of a body of unknown length while they are received."""

    def __init__(self, receive: Receive, limit: int) -> None:
        self._receive, self._limit, self._count = receive, limit, 0

    async def __call__(self) -> Message:
        message = await self._receive()
        self._count += len(message.get("body", b""))
        if self._count > self._limit:
            raise HTTPException(413, _too_large(f"over {self._limit}", self._limit))
        return message


def _too_large(count: str, limit: int) -> str:
    return f"a body of {count[:20]} bytes is over the limit of {limit}; split the file, or use: teachpath import"


def _refuse(status: int, sentence: str) -> JSONResponse:
    return JSONResponse({"detail": sentence, "error": "Refused"}, status)
