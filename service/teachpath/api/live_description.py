"""The description of the WebSockets in AsyncAPI 3, generated from their messages."""

from __future__ import annotations

from typing import Any, Final

from teachpath import __version__
from teachpath.api.live_messages import STATES, ChangeEvent, JointMessage, ResyncEvent
from teachpath.api.sample_messages import (
    EndMessage,
    PingMessage,
    PongMessage,
    RefusedMessage,
    ReportMessage,
    SampleMessage,
)
from teachpath.api.schemas import REFERENCE, Schema, schemas_of

DESCRIPTION: Final = """What a station says by itself, over WebSockets at its own host and port: `ws://HOST:PORT` and
the address of a channel, `wss://` where it is reached by https. Metres, radians, seconds; quaternions w, x, y, z;
times ending in `_ns` are nanoseconds since the Unix epoch. A connection shows the header Authorization, or cookie, of a
request. A query parameter or field that a channel does not know is refused with the nearest known name: code 1008, or
`refused`."""
EVENTS: Final = """Changes and states, so that nobody has to ask in a loop.

Resync: the first event is of topic `all`, and means: read everything anew; then come the states of all things. After
every new connection it is the same, so a client that reconnects has missed nothing. Numbers count up by one at the
station, but a client need not look for gaps: of each topic and id only the newest event waits for it.

Back-pressure: a client that reads slowly holds nobody up and costs no memory. When over 256 changed resources wait for
it, they become one event of topic `all`. Nothing may be sent to this channel: it closes with code 1008."""
JOINTS: Final = """What the arm does, at most 25 times a second while something changes, at least once a second.

Back-pressure: a client that reads slowly gets the newest state and none of those between. Nothing may be sent here."""
SAMPLES: Final = """Samples of a hand from a page or a program that does not speak Zenoh; `name` is the tracker's.

Connect, begin a recording of the name (`POST /api/v1/tasks/{task}/recording` with `{"tracker": NAME}`), and send one
sample after the other, numbered from any number on; `end` with the last number gives the `report`. A message that
cannot be used is answered with `refused`, and what it held is lost: listen. The rules of samples, and when a grasp
counts, are in proto/README.md; clients/examples/08_track_from_typescript.ts is such a program.

Binary messages are `HandSample` in protobuf (teachpath/v1/tracker.proto), text messages are JSON. The name
belongs to this connection: another one under it is refused with code 1008, unless it shows the same `session`. A
connection that sends nothing for 10 s, not even a ping, is closed. `end` waits until all samples have been recorded."""
VIEW: Final = """The 3-D view as batches of commands for meshcat, in MessagePack; for the station's own page.

The page answers each batch that it has drawn with their count so far, as text. While too many are undrawn, newer states
replace older ones."""
HAND_SAMPLE: Final = {"type": "string", "format": "binary", "description": "HandSample in protobuf."}
COMMANDS: Final = {"type": "string", "format": "binary", "description": "Commands for meshcat in MessagePack."}
COUNT: Final = {"type": "string", "pattern": "^[0-9]{1,8}$", "description": "How many batches have been drawn."}


def live_description() -> dict[str, Any]:
    """Return the description in AsyncAPI 3.0."""
    schemas = schemas_of([ChangeEvent, ResyncEvent, JointMessage, *STATES.values()])
    schemas |= schemas_of([PongMessage, ReportMessage, RefusedMessage])
    taken = schemas_of([SampleMessage, PingMessage, EndMessage])  # where an unknown field is refused
    schemas |= {name: schema | {"additionalProperties": False} for name, schema in taken.items()}
    states = {f"{topic}State": _state_event(topic, kind.__name__) for topic, kind in STATES.items()}
    changes = {"change": _named("ChangeEvent"), "resync": _named("ResyncEvent")}
    orders = {"sample": HAND_SAMPLE, "sampleInJson": _named("SampleMessage"), "ping": _named("PingMessage")}
    orders |= {"end": _named("EndMessage")}
    answers = {name: _named(f"{name.title()}Message") for name in ("pong", "report", "refused")}
    channels = {
        "events": _channel("/api/v1/events", EVENTS, changes | states),
        "joints": _channel("/api/v1/joints", JOINTS, {"joints": _named("JointMessage")}),
        "samples": _channel("/api/v1/trackers/{name}/samples", SAMPLES, orders | answers)
        | {"parameters": {"name": {"description": "name of the tracker"}}},
        "view": _channel("/api/v1/view", VIEW, {"commands": COMMANDS, "drawn": COUNT}),
    }
    return {
        "asyncapi": "3.0.0",
        "info": {"title": "teachpath, live", "version": __version__, "description": DESCRIPTION},
        "defaultContentType": "application/json",
        "channels": channels,
        "operations": {
            "watchEvents": _operation("send", "events", [*changes, *states]),
            "watchJoints": _operation("send", "joints", ["joints"]),
            "sendSamples": _operation("receive", "samples", list(orders)),
            "answerSamples": _operation("send", "samples", list(answers)),
            "watchView": _operation("send", "view", ["commands"]),
            "countDrawn": _operation("receive", "view", ["drawn"]),
        },
        "components": {"schemas": dict(sorted(schemas.items()))},
    }


def _named(model: str) -> Schema:
    return {"$ref": REFERENCE.format(model=model)}


def _state_event(topic: str, state: str) -> Schema:
    """Return the schema of an event that carries a state."""
    return {
        "type": "object",
        "description": f"How a thing of the topic {topic} stands; null: it has gone.",
        "required": ["sequence", "topic", "id", "now"],
        "properties": {
            "sequence": {"type": "integer", "description": "counts up by one for each change at the station"},
            "topic": {"const": topic, "description": "what the state is of"},
            "id": {"type": "string", "description": "of the thing: a tracker, a task; empty: there is one"},
            "now": {"anyOf": [_named(state), {"type": "null"}], "description": "its state"},
        },
    }


def _channel(address: str, description: str, messages: dict[str, Schema]) -> Schema:
    described = {name: {"name": name, "payload": payload} for name, payload in messages.items()}
    return {"address": address, "description": description, "messages": described}


def _operation(action: str, channel: str, messages: list[str]) -> Schema:
    """Return an operation of the station: it sends, or it receives."""
    place = f"#/channels/{channel}"
    named = [{"$ref": f"{place}/messages/{name}"} for name in messages]
    return {"action": action, "channel": {"$ref": place}, "messages": named}
