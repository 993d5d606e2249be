"""Middleware that ends a WebSocket when whoever opened it is known no longer."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import Final

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from teachpath.access.access import Access
from teachpath.api.access import SUBJECT
from teachpath.api.sockets import POLICY_VIOLATION

REASON: Final = "your token or session holds no longer; sign in again, or ask for another token"


class RevocableSockets:
    """Closes the WebSockets of a token that was revoked or has expired, and hears and says nothing there any more.

    Args:
        app: opens the WebSockets.
        access: says whose token holds no longer.
    """

    def __init__(self, app: ASGIApp, *, access: Access) -> None:
        self._app, self._access = app, access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a connection on."""
        if scope["type"] != "websocket":
            await self._app(scope, receive, send)
            return
        socket = _Socket(self._access, scope, receive, send)
        try:
            await self._app(scope, socket.receive, socket.send)
        finally:
            socket.forget()


class _Socket:
    def __init__(self, access: Access, scope: Scope, receive: Receive, send: Send) -> None:
        self._access, self._scope, self._receive, self._send = access, scope, receive, send
        self._loop = asyncio.get_running_loop()
        self._closing: asyncio.Task[None] | None = None
        self.forget: Callable[[], None] = lambda: None

    async def receive(self) -> Message:
        """Return what comes, as if the other side had left once the WebSocket was ended."""
        message = await self._receive()
        # Whoever does not answer the end of a WebSocket could go on sending.
        return {"type": "websocket.disconnect", "code": POLICY_VIOLATION} if self._closing else message

    async def send(self, message: Message) -> None:
        """Send a message, unless the WebSocket was ended."""
        if self._closing:
            return
        await self._send(message)
        if message["type"] == "websocket.accept":
            self.forget = self._access.call_at_end(self._scope[SUBJECT], self._end)

    def _end(self) -> None:
        with suppress(RuntimeError):  # the loop has ended meanwhile
            self._loop.call_soon_threadsafe(self._begin_to_close)

    def _begin_to_close(self) -> None:
        self._closing = self._closing or self._loop.create_task(self._close())

    async def _close(self) -> None:
        with suppress(RuntimeError):  # it is closed already
            await self._send({"type": "websocket.close", "code": POLICY_VIOLATION, "reason": REASON})
