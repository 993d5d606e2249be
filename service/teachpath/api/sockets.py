"""WebSockets: who may open one, and how a page is sent what waits for it."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from typing import Any, Final, Protocol, TypeVar
from urllib.parse import urlsplit

from fastapi import WebSocket, WebSocketDisconnect
from starlette.websockets import WebSocketState

from teachpath.api.closed import unknown

DONE: Final = 1000  # close codes: normal closure, and policy violation
REFUSED: Final = 1008
LONGEST_REASON: Final = 120  # bytes; the protocol allows 123

Piece = TypeVar("Piece", covariant=True)


class Reader(Protocol[Piece]):
    """Somebody for whom something may wait."""

    def pop(self) -> Piece | None:
        """Return what comes next, or None."""


Read = TypeVar("Read", bound=Reader[Any])


def same_origin(headers: Mapping[str, str]) -> bool:
    """Tell whether a request comes from our own page, or from no page at all (no Origin header)."""
    origin = headers.get("origin")
    return origin is None or urlsplit(origin).netloc.lower() == headers.get("host", "").lower()


async def admit(socket: WebSocket) -> bool:
    """Accept a WebSocket, and say whether it may stay.

    A page of another origin is refused: its handshake is answered with 403. So is a query parameter: there are none.
    """
    if not same_origin(socket.headers):
        await socket.close()
        return False
    await socket.accept()
    for name in socket.query_params:
        await close(socket, unknown("parameter", name, ()))
        return False
    return True


async def close(socket: WebSocket, reason: str = "") -> None:
    """Close a WebSocket that is still open: with a reason as refused, else as done."""
    if socket.client_state is WebSocketState.CONNECTED and socket.application_state is WebSocketState.CONNECTED:
        short = reason.encode(errors="replace")[:LONGEST_REASON].decode(errors="ignore")
        await socket.close(REFUSED if reason else DONE, short)


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
            await close(socket, fault)

    async def tell() -> None:
        with suppress(WebSocketDisconnect, RuntimeError):
            while True:
                await news.wait()
                news.clear()
                while (piece := reader.pop()) is not None:
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
