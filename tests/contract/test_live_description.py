"""The description of the WebSockets: complete, and true of what they send."""

import json
import re
import subprocess
import sys
from dataclasses import fields
from pathlib import Path
from typing import Any, get_args

from pydantic import TypeAdapter
from websockets.sync.client import connect

from teachpath.api import live_messages, sample_messages
from teachpath.api.live_description import live_description
from teachpath.io.store.tables import Base
from teachpath.live.event_hub import PRIVATE_TOPICS, EventHub
from teachpath.live.state_poller import StatePoller
from teachpath_proto import tracker_pb2
from tests.contract.desk import Desk, csv
from tests.waiting import HANG

DESCRIPTION: dict[str, Any] = live_description()
EXAMPLE = Path(__file__).parents[2] / "clients" / "examples" / "06_watch_events.py"


def test_every_field_and_channel_is_described() -> None:
    schemas = DESCRIPTION["components"]["schemas"]
    lacking = [
        f"{name}.{field}"
        for name, schema in schemas.items()
        for field, kind in schema.get("properties", {}).items()
        if not kind.get("description")
    ]
    assert lacking == []
    assert [name for name, channel in DESCRIPTION["channels"].items() if len(channel["description"]) < 100] == []


def test_every_reference_leads_somewhere() -> None:
    places = set(re.findall(r'"#/([\w/{}]+)"', json.dumps(DESCRIPTION)))
    assert len(places) > 10
    for place in places:
        found: Any = DESCRIPTION
        for step in place.split("/"):
            found = found[step]


def test_every_row_that_changes_has_its_topic() -> None:
    assert set(get_args(live_messages.Resource)) == set(Base.metadata.tables) - {"alembic_version"} - PRIVATE_TOPICS
    assert not set(get_args(live_messages.Resource)) & set(live_messages.STATES)


def test_events_are_as_described(desk: Desk, port: int) -> None:
    with connect(f"ws://127.0.0.1:{port}/api/v1/events") as socket:
        first = json.loads(socket.recv(timeout=HANG))
        TypeAdapter(live_messages.ResyncEvent).validate_python(first, extra="forbid")
        desk.put("/tasks/described", {})
        while (event := json.loads(socket.recv(timeout=HANG)))["id"] != "described":
            pass
        TypeAdapter(live_messages.ChangeEvent).validate_python(event, extra="forbid")


def test_states_are_as_described(desk: Desk) -> None:
    hub = EventHub()
    StatePoller(hub, desk.station._polls()).poll()
    subscriber, topics = hub.subscribe(lambda: None), set[str]()
    while event := subscriber.pop():
        topic = event.document["topic"]
        topics.add(topic)
        if topic != "all":
            state = TypeAdapter(live_messages.STATES[topic])
            state.validate_python(event.document["now"], extra="forbid")
    assert {"all", "station"} <= topics
    assert set(desk.station._polls()) == set(live_messages.STATES)


def test_a_sample_in_json_has_the_fields_of_the_message() -> None:
    kinds = {sample_messages.SampleFields: tracker_pb2.HandSample, sample_messages.SamplePosition: tracker_pb2.Vector3}
    kinds |= {sample_messages.SampleOrientation: tracker_pb2.Quaternion}
    for kind, message in kinds.items():
        assert {field.name for field in fields(kind)} == set(message.DESCRIPTOR.fields_by_name)


def test_a_sample_in_json_may_say_its_time_as_text(port: int) -> None:
    sample = {"sequence": 1, "position": {"x": 0.5, "y": 0.0, "z": 0.5}, "tracked": True}
    with connect(f"ws://127.0.0.1:{port}/api/v1/trackers/page-of-text/samples") as socket:
        for stamp in ("1796106334268000001", "1796106334288000001n", "-1", "9" * 40, ""):
            socket.send(json.dumps({"sample": sample | {"device_ns": stamp}}))
        refusals = [json.loads(socket.recv(timeout=HANG))["refused"] for _ in range(4)]
        assert all("no HandSample" in sentence for sentence in refusals)
        socket.send(json.dumps({"ping": 1}))
        assert json.loads(socket.recv(timeout=HANG))["samples"] == {"passed": 1, "refused": 4}


def test_answers_to_a_tracker_are_as_described(port: int) -> None:
    with connect(f"ws://127.0.0.1:{port}/api/v1/trackers/page-described/samples") as socket:
        for order, kind in (({"ping": 1.5}, sample_messages.PongMessage), ({"end": 3}, sample_messages.RefusedMessage)):
            socket.send(json.dumps(order))
            TypeAdapter(kind).validate_python(json.loads(socket.recv(timeout=HANG)), extra="forbid")


def test_the_descriptions_are_served_beside_each_other(desk: Desk) -> None:
    assert desk.send("GET", "/asyncapi.json").json() == DESCRIPTION


def test_the_example_watches_until_a_job_has_ended(desk: Desk, port: int) -> None:
    command = [sys.executable, str(EXAMPLE), "--url", f"http://127.0.0.1:{port}", "--until-job"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as watching:
        try:
            assert watching.stdout is not None
            assert "read everything anew" in watching.stdout.readline()
            desk.import_("watched", csv())
            lines, errors = watching.communicate(timeout=HANG)
        finally:
            watching.kill()
    assert watching.returncode == 0, errors
    assert "import of watched): succeeded 100%" in lines
