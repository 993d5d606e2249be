"""WebSockets: who may open one, and how a page is sent what waits for it."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from typing import Any, Protocol, TypeVar
from urllib.parse import urlsplit

from fastapi import WebSocket, WebSocketDisconnect

Piece = TypeVar("Piece", covariant=True)


class Reader(Protocol[Piece]):
    """Somebody for whom something may wait."""

    def take(self) -> Piece | None:
        """Return what comes next, or None."""


Read = TypeVar("Read", bound=Reader[Any])


def same_origin(headers: Mapping[str, str]) -> bool:
    """Tell whether a request comes from our own page, or from no page at all (no Origin header)."""
    origin = headers.get("origin")
    return origin is None or urlsplit(origin).netloc.lower() == headers.get("host", "").lower()


async def admit(socket: WebSocket) -> bool:
    """Accept a WebSocket, unless a page of another origin opens it: that handshake is answered with 403."""
    if not same_origin(socket.headers):
        await socket.close()
        return False
    await socket.accept()
    return True


async def serve(
    socket: WebSocket,
    attach: Callable[[Callable[[], None]], Read],
    detach: Callable[[Read], None],
    send: Callable[[Any], Awaitable[None]],
    receive: Callable[[str, Read], str],
) -> None:
    """Send what waits, as it comes, until the page leaves.

    Args:
        attach: makes the reader; its argument wakes us, from any thread, when something waits.
        detach: forgets the reader.
        send: sends one piece.
        receive: takes what the page says; returns why it cannot be used, which closes the socket, or nothing.
    """
    loop, news = asyncio.get_running_loop(), asyncio.Event()

    def wake() -> None:
        with suppress(RuntimeError):  # the loop has ended meanwhile
            loop.call_soon_threadsafe(news.set)

    async def listen() -> None:
        with suppress(WebSocketDisconnect, KeyError):  # KeyError: bytes where text belongs
            while not (fault := receive(await socket.receive_text(), reader)):
                pass
            await socket.close(1008, fault)

    async def tell() -> None:
        with suppress(WebSocketDisconnect, RuntimeError):
            while True:
                await news.wait()
                news.clear()
                while (piece := reader.take()) is not None:
                    await send(piece)

    reader = attach(wake)
    news.set()
    tasks = [asyncio.create_task(listen()), asyncio.create_task(tell())]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        detach(reader)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
