"""The joint states: a WebSocket that sends what the arm does and the status of its execution."""

from __future__ import annotations

import asyncio
import json
import time
from dataclasses import asdict
from typing import Any, Final

from fastapi import APIRouter, WebSocket, WebSocketDisconnect

from teachpath.api import sockets
from teachpath.api.access import VIEW
from teachpath.api.parts import Parts
from teachpath.records import ExecutorStatus
from teachpath.robot.joint_feed import JointFrame

FRAME_RATE: Final = 25.0  # [Hz] joint frames to a page, at most
MAX_SILENCE: Final = 1.0  # [s] between two frames of an arm at rest


def joints_router(parts: Parts) -> APIRouter:
    """Return the WebSocket `/joints`."""
    router = APIRouter()

    @router.websocket("/joints", dependencies=VIEW)
    async def joints(socket: WebSocket) -> None:
        """Send the joint state whenever it has changed; refuse a page of another origin."""
        if not await sockets.accept(socket):
            return
        listening, sending = asyncio.create_task(_listen(socket)), asyncio.create_task(_send(socket, parts))
        await asyncio.wait((listening, sending), return_when=asyncio.FIRST_COMPLETED)
        for task in (listening, sending):
            task.cancel()
        await asyncio.gather(listening, sending, return_exceptions=True)

    return router


async def _listen(socket: WebSocket) -> None:
    """Wait until the page leaves; close the socket when it sends anything."""
    message = await socket.receive()
    if message["type"] == "websocket.receive":
        await socket.close(1008, "nothing is expected here; give orders over REST")


async def _send(socket: WebSocket, parts: Parts) -> None:
    """Send the newest joint state with the executor's status whenever one of them has changed."""
    onlooker = parts.joints.subscribe()
    before, told = dict[str, Any](), -MAX_SILENCE
    try:
        while True:
            frame, now = onlooker.poll(), time.monotonic()
            if frame is not None:
                document = _document(frame, parts.executions.status)
                if document != before or now - told >= MAX_SILENCE:
                    await socket.send_text(json.dumps({"stamp_ns": frame.state.stamp_ns, **document}))
                    before, told = document, now
            await asyncio.sleep(1.0 / FRAME_RATE)
    except (WebSocketDisconnect, RuntimeError):
        return
    finally:
        parts.joints.unsubscribe(onlooker)


def _document(frame: JointFrame, status: ExecutorStatus | None) -> dict[str, Any]:
    """Return a `JointMessage` without its time."""
    state = frame.state
    return {
        "execution": state.execution,
        "position": [round(v, 5) for v in state.position.tolist()],
        "velocity": [round(v, 5) for v in state.velocity.tolist()],
        "speed": [round(v, 5) for v in frame.speed],
        "torque": [round(v, 3) for v in state.torque.tolist()],
        "tracking_error": round(frame.tracking_error, 7),
        "lateness": frame.lateness,
        "missed": state.missed,
        "holding": state.holding,
        "gripper_closed": state.gripper_closed,
        "gripper_opening": None if state.gripper_opening is None else round(state.gripper_opening, 4),
        "output": state.output,
        "enabled": state.enabled,
        "protective_stop": state.protective_stop,
        "fault": state.fault,
        "status": asdict(status) if status else None,
    }
