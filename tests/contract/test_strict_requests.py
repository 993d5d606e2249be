"""Strict requests: no operation and no WebSocket drops without a word what it does not know."""

import json
import re
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from teachpath.api.faults import MAX_FAULTS
from tests.contract import openapi
from tests.contract.desk import API, Desk, refused
from tests.waiting import HANG

DESCRIPTION: dict[str, Any] = json.loads(openapi.FILE.read_text())
STOPS = {f"{API}/stop", f"{API}/executions/{{execution}}/stop"}  # answered whatever comes with them
SPARE = "xyzzy"
OPERATIONS = [
    (method.upper(), path, operation)
    for path, methods in DESCRIPTION["paths"].items()
    for method, operation in methods.items()
    if path not in STOPS
]
NAMES = [f"{method} {path}" for method, path, _ in OPERATIONS]


def word(schema: dict[str, Any]) -> Any:
    """Return a word that an address may hold in a place."""
    if "enum" in schema:
        return schema["enum"][0]
    return "0" * 32 if "pattern" in schema else {"integer": 1}.get(schema.get("type", ""), "moon")


def address(path: str, operation: dict[str, Any]) -> str:
    """Return an address of an operation; what it names is nowhere."""
    words = {p["name"]: word(p["schema"]) for p in operation.get("parameters", [])}
    return re.sub(r"\{(\w+)\}", lambda found: str(words[found[1]]), path)


def model(operation: dict[str, Any]) -> dict[str, Any] | None:
    """Return the schema of an operation's JSON body, None when it takes none."""
    schema = operation.get("requestBody", {}).get("content", {}).get("application/json", {}).get("schema")
    if schema is None:
        return None
    reference = next(s["$ref"] for s in [schema, *schema.get("anyOf", [])] if "$ref" in s)
    found: dict[str, Any] = DESCRIPTION["components"]["schemas"][reference.rsplit("/", 1)[1]]
    return found


@pytest.mark.parametrize(("method", "path", "operation"), OPERATIONS, ids=NAMES)
def test_an_unknown_parameter_is_refused_and_the_nearest_is_offered(
    desk: Desk, method: str, path: str, operation: dict[str, Any]
) -> None:
    known = [p["name"] for p in operation.get("parameters", []) if p["in"] == "query"]
    for name, said in [(SPARE, "known here: " + (", ".join(known) or "none"))] + [
        (f"{name[:1]}{name}", f"did you mean {name}?") for name in known
    ]:
        answer = desk.send(method, address(path, operation), params={name: "1"})
        assert answer.status_code == 422, answer.text
        faults = {fault["place"]: fault["fault"] for fault in answer.json()["errors"]}
        assert said in faults[f"query.{name}"]


@pytest.mark.parametrize(("method", "path", "operation"), OPERATIONS, ids=NAMES)
def test_an_unknown_field_is_refused_and_the_known_ones_are_named(
    desk: Desk, method: str, path: str, operation: dict[str, Any]
) -> None:
    schema = model(operation)
    if schema is None:
        if "requestBody" not in operation:
            refused(desk.send(method, address(path, operation), json={SPARE: 1}), 422, "takes none")
        return
    known = list(schema["properties"])
    answer = desk.send(method, address(path, operation), json={SPARE: 1})
    assert answer.status_code == 422, answer.text
    faults = {fault["place"]: fault["fault"] for fault in answer.json()["errors"]}
    assert f"known here: {', '.join(known)}" in faults[f"body.{SPARE}"]


def objects(schema: dict[str, Any], place: str = "body") -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield every object that a body may hold, with its place: `body.points.0` is the first of a list."""
    yield place, schema
    for field, kind in schema["properties"].items():
        steps = f"{place}.{field}{'.0' if 'items' in kind else ''}"
        for name in re.findall(r"#/components/schemas/(\w+)", json.dumps(kind)):
            if "properties" in (inner := DESCRIPTION["components"]["schemas"][name]):
                yield from objects(inner, steps)


def body(place: str, inner: dict[str, Any]) -> Any:
    """Return a body that holds an object at a place."""
    whole: Any = inner
    for step in reversed(place.split(".")[1:]):
        whole = [whole] if step == "0" else {step: whole}
    return whole


@pytest.mark.parametrize(
    ("method", "path", "operation"),
    [each for each in OPERATIONS if model(each[2]) is not None],
    ids=[name for name, each in zip(NAMES, OPERATIONS, strict=True) if model(each[2]) is not None],
)
def test_a_slip_in_any_field_at_any_depth_is_refused_and_the_field_is_offered(
    desk: Desk, method: str, path: str, operation: dict[str, Any]
) -> None:
    schema = model(operation)
    assert schema is not None
    for place, inner in objects(schema):
        names = list(inner["properties"])
        for first in range(0, len(names), MAX_FAULTS // 2):
            slips = {f"{name[:1]}{name}": name for name in names[first : first + MAX_FAULTS // 2]}
            answer = desk.send(method, address(path, operation), json=body(place, dict.fromkeys(slips, 1)))
            assert answer.status_code == 422, answer.text
            faults = {fault["place"]: fault["fault"] for fault in answer.json()["errors"]}
            for slip, name in slips.items():
                assert f"did you mean {name}?" in faults[f"{place}.{slip}"]


@pytest.mark.parametrize(
    ("resource", "body", "place"),
    [
        ("/executions", {"plan": "moon", "override": True}, "body.override"),
        ("/executions", {"plan": "moon", "override": "0.2"}, "body.override"),
        ("/paths/moon/plans", {"version": "1"}, "body.version"),
        ("/paths/moon/adaptations", {"goal": {"position": [0.5, True, 0.5]}}, "body.goal.position.1"),
        ("/lease", {"name": "ada", "hold_when_lost": "yes"}, "body.hold_when_lost"),
        ("/tasks/moon/recording", {"tracker": "glove", "takes": False}, "body.takes"),
    ],
)
def test_a_value_of_another_kind_is_no_number(desk: Desk, resource: str, body: Any, place: str) -> None:
    answer = desk.post(resource, body)
    assert answer.status_code == 422, answer.text
    assert [fault["place"] for fault in answer.json()["errors"]] == [place]


def test_every_object_of_a_request_is_closed() -> None:
    schemas = DESCRIPTION["components"]["schemas"]
    waiting = [model(operation) for _, _, operation in OPERATIONS]
    while waiting:
        schema = waiting.pop()
        if schema is None or "enum" in schema:  # a word is no object
            continue
        assert schema["additionalProperties"] is False, schema["title"]
        inner = re.findall(r"#/components/schemas/(\w+)", json.dumps(schema))
        waiting += [schemas[name] for name in inner]


def test_a_field_within_a_field_is_named(desk: Desk) -> None:
    point = {"tracker": [0, 0, 0], "world": [0, 0, 0], "wrold": 1}
    refused(desk.put("/calibrations/x", {"points": [point]}), 422, "body.points.0.wrold: there is no field 'wrold'")
    curve = {"degree": 1, "knots": [0, 0, 1, 1], "control_points": [[0, 0, 0], [1, 0, 0]], "weights": [1, 1], "knot": 1}
    answer = desk.post("/paths/moon/assessment", {"curve": curve})
    refused(answer, 422, "body.curve.knot: there is no field 'knot'; did you mean knots?")


@pytest.mark.parametrize("resource", ["events?task=x", "joints?rate=1", "trackers/page-9/samples?rate=1"])
def test_a_socket_has_no_parameters(port: int, resource: str) -> None:
    with connect(f"ws://127.0.0.1:{port}/api/v1/{resource}") as socket:
        with suppress(ConnectionClosed):
            socket.recv(timeout=HANG)
        assert socket.close_code == 1008
        assert "there is no parameter" in (socket.close_reason or "")


@pytest.mark.parametrize(
    ("message", "sentence"),
    [
        ({"end": 3, "discrad": True}, "there is no field 'discrad'; did you mean discard?"),
        ({"ping": 1, "pong": 1}, "there is no field 'pong'; did you mean ping?"),
        ({"sample": {}, "rate": 1}, "there is no field 'rate'; known here: sample"),
        ({"sample": {"secuence": 1}}, "no HandSample"),
    ],
)
def test_a_message_of_a_tracker_is_closed(port: int, message: dict[str, Any], sentence: str) -> None:
    with connect(f"ws://127.0.0.1:{port}/api/v1/trackers/page-closed/samples") as socket:
        socket.send(json.dumps(message))
        assert sentence in json.loads(socket.recv(timeout=HANG))["refused"]
