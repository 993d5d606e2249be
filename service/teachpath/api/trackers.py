"""Trackers over a WebSocket: the page's own hand, and any program that prefers one to Zenoh.

Page to service, binary: a `HandSample` as protobuf. Text: a JSON object with one of
- `sample`: a `HandSample` with the names of its fields;
- `ping`: a number, answered at once with `pong` (the same number), `service_ns`, and `samples`, how many were `passed`
  on and `refused`;
- `end`: number of the last sample sent, with `discard` if the open demonstration is to be thrown away; answered with
  `report`, the account of the recording.
A name belongs to who is connected under it: nobody else may connect under it meanwhile. With the query parameter
`session`, a secret of its own, a page comes back before its broken connection is given up.

Service to page, text: those answers, and `refused` (a sentence) for every message that cannot be used.
"""

from __future__ import annotations

import asyncio
import json
import time
from contextlib import suppress
from typing import Any, Final

from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from starlette.concurrency import run_in_threadpool

from teachpath.api import sockets
from teachpath.api.access import DEMONSTRATE, SUBJECT
from teachpath.api.parts import Parts
from teachpath.api.strict_requests import unknown_name
from teachpath.errors import TeachpathError, UnusableInput
from teachpath.io.wire import MAX_SAMPLE_SIZE
from teachpath.recorder.websocket_trackers import WebSocketTracker
from teachpath.records import Subject

SILENCE_TIMEOUT: Final = 10.0  # [s] after which a page that says nothing, not even a ping, has gone
MAX_SESSION_LENGTH: Final = 64  # characters of the secret by which a page comes back
MAX_PING: Final = 1e18  # what is no number, or infinite, could not be answered in JSON

FIELDS_OF_KIND: Final[dict[str, tuple[str, ...]]] = {
    "sample": ("sample",),
    "ping": ("ping",),
    "end": ("end", "discard"),
}  # of each kind of message

Answer = dict[str, Any]


def trackers_router(parts: Parts, *, silence: float = SILENCE_TIMEOUT) -> APIRouter:
    """Return the WebSocket `/trackers/{name}/samples`."""
    router = APIRouter()

    @router.websocket("/trackers/{name}/samples", dependencies=DEMONSTRATE)
    async def samples(socket: WebSocket, name: str, session: str = "") -> None:
        """Take the samples of a tracker that `name` names; `session` is the secret by which a page comes back to it."""
        if not await sockets.accept(socket, parameters=("session",)):
            return
        loop, dismissed = asyncio.get_running_loop(), asyncio.Queue[str]()

        def leave(why: str) -> None:
            """Let the socket be closed with a reason; any thread may call it."""
            with suppress(RuntimeError):  # the loop has ended meanwhile
                loop.call_soon_threadsafe(dismissed.put_nowait, why)

        try:
            subject: Subject = socket.scope[SUBJECT]
            tracker = parts.websocket_trackers.register(name, leave, session[:MAX_SESSION_LENGTH], subject=subject.name)
        except TeachpathError as error:
            await sockets.close(socket, str(error))
            return
        listening = asyncio.create_task(_listen(socket, tracker, silence))
        leaving = asyncio.create_task(dismissed.get())
        try:
            done, _ = await asyncio.wait((listening, leaving), return_when=asyncio.FIRST_COMPLETED)
            await sockets.close(socket, next(iter(done)).result())
        finally:
            parts.websocket_trackers.unregister(tracker)
            for task in (listening, leaving):
                task.cancel()
            await asyncio.gather(listening, leaving, return_exceptions=True)

    return router


async def _listen(socket: WebSocket, tracker: WebSocketTracker, silence: float) -> str:
    """Answer messages; return why the tracker must be disconnected, or an empty text when it has left."""
    try:
        while True:
            message = await asyncio.wait_for(socket.receive(), silence)
            if message["type"] == "websocket.disconnect":
                return ""
            # On another thread: the bus may make a publisher wait.
            answer = await run_in_threadpool(_answer, tracker, message.get("bytes") or message.get("text") or "")
            if answer:
                await socket.send_text(json.dumps(answer))
    except UnusableInput as error:
        return str(error)
    except TimeoutError:
        return f"nothing came for {silence:g} s, not even a ping"
    except (WebSocketDisconnect, RuntimeError):
        return ""


def _answer(tracker: WebSocketTracker, content: bytes | str) -> Answer:
    """Handle a message and return the answer; raises UnusableInput when the tracker must be disconnected."""
    if isinstance(content, bytes):
        return _refusal(tracker.publish(content))
    order = _parse(content)
    if stray := _stray(order):
        return _refusal(tracker.refuse(stray))
    if isinstance(order.get("sample"), dict):
        return _refusal(tracker.publish(order["sample"]))
    ping, end = order.get("ping"), order.get("end")
    if isinstance(ping, int | float) and abs(ping) < MAX_PING:
        counts = {"passed": tracker.accepted, "refused": tracker.refused}
        return {"pong": ping, "service_ns": time.time_ns(), "samples": counts}
    if isinstance(end, int) and 0 <= end < 2**64:
        try:
            return {"report": tracker.end_recording(end, discard=order.get("discard") is True)}
        except TeachpathError as error:
            return {"refused": str(error)}
    return _refusal(tracker.refuse(f"{content[:80]!r} is no message of a tracker: send sample, ping or end"))


def _parse(text: str) -> Answer:
    try:
        order = json.loads(text) if len(text) <= MAX_SAMPLE_SIZE else None
    except (ValueError, RecursionError):
        order = None
    return order if isinstance(order, dict) else {}


def _stray(order: Answer) -> str:
    """Return a sentence about a field that this kind of message does not have; empty when there is none."""
    kind = next((kind for kind in FIELDS_OF_KIND if kind in order), None)
    known = FIELDS_OF_KIND[kind] if kind else ()
    return next((unknown_name("field", name, known) for name in order if kind and name not in known), "")


def _refusal(sentence: str) -> Answer:
    return {"refused": sentence} if sentence else {}
