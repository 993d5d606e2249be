"""The events: a WebSocket that sends changes and states, so that a page need not poll.

Each message is one JSON document (`live_messages.py`): `{"sequence", "topic", "id"}` says that a resource has changed,
of a job or an execution with `status` also how it stands; with `now` it carries a state (null: the thing has gone).
The topic `all` means: read everything anew. It comes first, and again when a subscriber has fallen behind. Topics are
the names of the resources (tasks, demonstrations, runs, paths, plans, jobs, executions), and, with `now`, `station`,
`executor` (also who has control), `trackers`, `recordings` and `guidance`.
"""

from __future__ import annotations

from fastapi import APIRouter, WebSocket

from teachpath.api import sockets
from teachpath.api.access import VIEW
from teachpath.live.event_hub import Event, EventHub, Subscriber


def events_router(hub: EventHub) -> APIRouter:
    """Return the route of the events: `/api/v1/events`."""
    router = APIRouter(include_in_schema=False)

    @router.websocket("/api/v1/events", dependencies=VIEW)
    async def events(socket: WebSocket) -> None:
        """Send what changes at the station, of each topic and id the newest."""

        async def send(event: Event) -> None:
            await socket.send_text(event.text)

        if await sockets.accept(socket):
            await sockets.serve(socket, hub.subscribe, hub.unsubscribe, send, _refuse)

    return router


def _refuse(text: str, subscriber: Subscriber) -> str:
    return "nothing is expected here; give orders over REST"
