"""Middleware: JSON documents that are read are sent compressed, to whom takes them so."""

from __future__ import annotations

import gzip
from typing import Final

from anyio.to_thread import run_sync
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

LEAST_COMPRESSED: Final = 1000  # bytes; a shorter document gains nothing
LEVEL: Final = 6
JSON: Final = "application/json"


class CompressedDocuments:
    """Compresses the answers of GET that are one JSON document, on a thread of their own: no other request waits."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on."""
        if scope["type"] != "http" or scope["method"] != "GET":
            await self._app(scope, receive, send)
            return
        takes_gzip = "gzip" in Headers(scope=scope).get("accept-encoding", "")
        head: Message | None = None  # until it is known whether the body follows as one piece

        async def compressed(message: Message) -> None:
            """Hold the head back until the body comes."""
            nonlocal head
            if message["type"] == "http.response.start":
                head = message
                return
            if head is not None:
                message = await _compressed(head, message, takes_gzip)
                await send(head)
                head = None
            await send(message)

        await self._app(scope, receive, compressed)


async def _compressed(head: Message, body: Message, takes_gzip: bool) -> Message:
    """Return the body of an answer as it is sent, of which its headers are told."""
    headers = MutableHeaders(raw=head["headers"])
    if headers.get("content-type", "") != JSON or "content-encoding" in headers:
        return body
    headers.add_vary_header("Accept-Encoding")
    plain = body.get("body", b"")
    if not takes_gzip or body.get("more_body", False) or len(plain) < LEAST_COMPRESSED:
        return body
    packed = await run_sync(lambda: gzip.compress(plain, LEVEL, mtime=0))
    headers["Content-Encoding"], headers["Content-Length"] = "gzip", str(len(packed))
    return {**body, "body": packed}
