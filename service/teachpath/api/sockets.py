"""WebSockets: which clients may open one, and how pending messages are sent."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Collection, Mapping
from contextlib import suppress
from functools import partial
from typing import Any, Final, Protocol, TypeVar

from fastapi import WebSocket, WebSocketDisconnect
from starlette.websockets import WebSocketState

from teachpath.access.loopback import authority_of
from teachpath.api.send_pacer import pacer_of_running_loop
from teachpath.api.strict_requests import unknown_name

NORMAL_CLOSURE: Final = 1000  # close codes: normal closure, and policy violation
POLICY_VIOLATION: Final = 1008
MAX_REASON_LENGTH: Final = 120  # bytes; the protocol allows 123

Message = TypeVar("Message", covariant=True)


class MessageSource(Protocol[Message]):
    """A source of messages for one page."""

    def pop(self) -> Message | None:
        """Remove and return the next message, or None while none waits."""


Source = TypeVar("Source", bound=MessageSource[Any])


def same_origin(headers: Mapping[str, str]) -> bool:
    """Tell whether a request comes from our own page, or from no page at all (no Origin header)."""
    origin = headers.get("origin")
    return origin is None or authority_of(origin) == (headers.get("host", "").lower() or None)


async def accept(socket: WebSocket, *, parameters: Collection[str] = ()) -> bool:
    """Accept a WebSocket, and say whether it may stay.

    A page of another origin is refused: its handshake is answered with 403. So is a query parameter that is not among
    `parameters`.
    """
    if not same_origin(socket.headers):
        await socket.close()
        return False
    await socket.accept()
    for name in socket.query_params:
        if name not in parameters:
            await close(socket, unknown_name("parameter", name, tuple(parameters)))
            return False
    return True


async def close(socket: WebSocket, reason: str = "") -> None:
    """Close a WebSocket that is still open; a reason makes it a refusal."""
    if socket.client_state is WebSocketState.CONNECTED and socket.application_state is WebSocketState.CONNECTED:
        short = reason.encode(errors="replace")[:MAX_REASON_LENGTH].decode(errors="ignore")
        await socket.close(POLICY_VIOLATION if reason else NORMAL_CLOSURE, short)


async def serve(
    socket: WebSocket,
    connect: Callable[[Callable[[], None]], Source],
    disconnect: Callable[[Source], None],
    send: Callable[[Any], Awaitable[None]],
    receive: Callable[[str, Source], str],
) -> None:
    """Send messages as they come, one after another and in turn with other sockets, until the page leaves.

    Args:
        connect: makes the source; its argument is to be called, from any thread, when a message waits.
        disconnect: forgets the source.
        send: sends one message.
        receive: called with each text of the page; returns why it cannot be used, which closes the socket, or nothing.
    """
    waiting = asyncio.Event()
    wake = partial(pacer_of_running_loop().wake, waiting)

    async def listen() -> None:
        with suppress(WebSocketDisconnect, KeyError):  # KeyError: bytes where text belongs
            while not (fault := receive(await socket.receive_text(), source)):
                pass
            await close(socket, fault)

    async def forward() -> None:
        """Send what the source has, one message at a time, until the page is gone."""
        with suppress(WebSocketDisconnect, RuntimeError):
            while True:
                await waiting.wait()
                waiting.clear()
                if (message := source.pop()) is not None:
                    await send(message)
                    wake()  # for the next message, behind the other sockets

    source = connect(wake)
    wake()
    tasks = [asyncio.create_task(listen()), asyncio.create_task(forward())]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        disconnect(source)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
