"""The REST API of a station: what it answers, above all to what cannot be used. Never a status 500."""

import json
import re
from collections.abc import AsyncIterator
from typing import Any
from urllib.parse import quote

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.contract import client_models, openapi
from tests.contract.desk import API, Desk, csv, refused

# what is not there

NEEDED_BODIES = {
    "/tasks/moon/jobs": {},
    "/tasks/moon/recording": {"tracker": "glove"},
    "/tasks/moon/recording/stop": {"tracker": "glove"},
    "/executions/moon/override": {"override": 0.5},
}


@pytest.mark.parametrize(
    ("method", "resource", "what"),
    [
        ("GET", "/tasks/moon", "task 'moon'"),
        ("GET", "/tasks/moon/demonstrations", "task 'moon'"),
        ("GET", "/tasks/moon/recording", "task 'moon'"),
        ("GET", "/tasks/moon/jobs", "task 'moon'"),
        ("GET", "/tasks/moon/runs", "task 'moon'"),
        ("GET", "/tasks/moon/runs/run-1", "run 'run-1'"),
        ("GET", "/tasks/moon/runs/run-1/dendrogram", "run 'run-1'"),
        ("POST", "/tasks/moon/jobs", "task 'moon'"),
        ("POST", "/tasks/moon/recording", "task 'moon'"),
        ("POST", "/tasks/moon/recording/stop", "task 'moon'"),
        ("GET", "/demonstrations/moon", "demonstration 'moon'"),
        ("GET", "/demonstrations/moon/trajectory", "demonstration 'moon'"),
        ("GET", "/demonstrations/moon/recording", "demonstration 'moon'"),
        ("GET", "/jobs/moon", "job 'moon'"),
        ("POST", "/jobs/moon/cancel", "job 'moon'"),
        ("GET", "/paths/moon", "path 'moon'"),
        ("GET", "/paths/moon/plans", "path 'moon'"),
        ("POST", "/paths/moon/plans", "path 'moon'"),
        ("GET", "/plans/moon", "plan 'moon'"),
        ("GET", "/executions/moon", "execution 'moon'"),
        ("POST", "/executions/moon/override", "execution 'moon'"),
        ("POST", "/executions/moon/stop", "execution 'moon'"),
        ("POST", "/executions/moon/hold", "execution 'moon'"),
    ],
)
def test_what_is_not_there_is_404_and_named(desk: Desk, method: str, resource: str, what: str) -> None:
    answer = desk.send(method, API + resource, json=NEEDED_BODIES.get(resource) if method == "POST" else None)
    refused(answer, 404, f"there is no {what}")


def test_what_a_body_names_and_is_not_there_is_422(desk: Desk) -> None:
    refused(desk.post("/executions", {"plan": "moon"}), 422, "body.plan: there is no plan 'moon'")
    refused(desk.put("/tasks/x", {"calibration": "moon"}), 422, "body.calibration: there is no calibration 'moon'")


def test_head_answers_like_get_without_the_body(desk: Desk) -> None:
    head, get = desk.send("HEAD", f"{API}/tasks"), desk.get("/tasks")
    assert (head.status_code, head.content) == (200, b"")
    assert head.headers["content-length"] == get.headers["content-length"]
    assert desk.send("HEAD", f"{API}/tasks/moon").status_code == 404


def test_all_methods_of_an_address_are_said_to_be_allowed(desk: Desk) -> None:
    assert desk.post("/tasks/moon", {}).headers["allow"] == "DELETE, GET, HEAD, PATCH, PUT"


def test_a_wrong_address_and_a_wrong_method_say_where_to_look(desk: Desk) -> None:
    refused(desk.get("/nothing"), 404, "/docs")
    answer = desk.send("DELETE", f"{API}/tasks")
    refused(answer, 405, "allowed here: GET")
    assert answer.headers["allow"] == "GET, HEAD"


@pytest.mark.parametrize("name", ["..", "a..b", "%2e%2e", "a%2Fb", "%00", "a%0Ab", "a b", "é", "-a", "x" * 65, "%ff"])
def test_a_bad_task_name_makes_nothing(desk: Desk, name: str) -> None:
    before = desk.get("/tasks").json()
    for answer in (desk.put(f"/tasks/{name}", {}), desk.upload(name, csv())):
        assert answer.status_code in (404, 405, 422), answer.text
        assert len(answer.json()["detail"]) > 20
    assert desk.get("/tasks").json() == before


def test_a_name_of_64_characters_is_one(desk: Desk) -> None:
    assert desk.put(f"/tasks/{'x' * 64}", {}).json()["scene"] == "paper"
    refused(desk.put(f"/tasks/{'x' * 65}", {}), 422, "1 to 64")


def test_a_task_that_exists_stays_as_it_is(desk: Desk) -> None:
    made = desk.put("/tasks/kept", {"scene": "empty"}).json()
    for same in ({}, {"scene": "empty"}, {"scene": "empty", "calibration": "identity", "object_at_grasp": False}):
        assert desk.put("/tasks/kept", same).json() == made
    refused(desk.put("/tasks/kept", {"scene": "paper"}), 409, "its scene is empty, not paper")
    refused(desk.put("/tasks/kept", {"object_at_grasp": True}), 409, "leave object_at_grasp out")
    assert desk.get("/tasks/kept").json() == made
    refused(desk.put("/tasks/new", {"scene": "moon"}), 422, "no scene 'moon'; known: paper, empty")
    refused(desk.put("/tasks/new", {"calibration": "moon"}), 422, "no calibration 'moon'")
    assert desk.get("/tasks/new").status_code == 404


# bodies that cannot be used

BODIES = {
    b"": "body: Field required",
    b"{": "body: this is no JSON",
    b"[]": "body: it should be a valid dictionary or object",
    b"{}": "body.plan: Field required",
    b'{"plan": 3}': "body.plan: it should be a valid string",
    b'{"plan": "p", "override": NaN}': "body.override: it should be",
    b'{"plan": "p", "override": Infinity}': "body.override: it should be less than or equal to 1",
    b'{"plan": "p", "override": 2}': "body.override: it should be less than or equal to 1",
    b'{"plan": 1, "override": -1}': "and 1 more",
    b'{"plan": "\\ud800"}': "half of a surrogate pair",
    b"\xff\xfe": "body",
    b"[" * 100_000: "body",
    b"1" * 10_000: "body",
}


@pytest.mark.parametrize("body", BODIES, ids=lambda b: b[:30])
def test_a_wrong_body_is_one_sentence_that_names_the_field(desk: Desk, body: bytes) -> None:
    answer = desk.post("/executions", json=None, content=body, headers={"content-type": "application/json"})
    assert answer.status_code in (400, 422)
    refused(answer, answer.status_code, BODIES[body])


@pytest.mark.parametrize("kind", ["text/plain", "application/x-www-form-urlencoded", "multipart/form-data", "x"])
def test_a_body_that_is_not_declared_as_json_is_refused(desk: Desk, kind: str) -> None:
    answer = desk.post("/executions", json=None, content=b'{"plan": "p"}', headers={"content-type": kind})
    refused(answer, 422, "body")


def test_a_body_over_the_limit_is_413_whether_announced_or_not(desk: Desk) -> None:
    async def chunks(size: int) -> AsyncIterator[bytes]:
        for _ in range(0, size, 100_000):
            yield bytes(100_000)

    refused(desk.upload("huge", bytes(2_000_001)), 413, "2000001 bytes is over the limit of 2000000; split the file")
    refused(desk.upload("huge", chunks(2_100_000)), 413, "over the limit of 2000000")
    document = {"content-type": "application/json"}
    answer = desk.post("/executions", json=None, content=chunks(1_200_000), headers=document)
    refused(answer, 413, "over the limit of 1048576")
    refused(desk.post("/executions", {"plan": "p" * 1_100_000}), 413, "over the limit of 1048576")
    assert desk.get("/tasks/huge").status_code == 404


# who may ask


def test_a_foreign_host_is_refused(desk: Desk) -> None:
    assert desk.get("/health", headers={"host": "evil.example"}).status_code == 400
    for host in ("localhost:8765", "127.0.0.1"):
        assert desk.get("/health", headers={"host": host}).status_code == 200


def test_a_page_of_another_origin_gives_no_orders(desk: Desk) -> None:
    ours, theirs = {"origin": "http://127.0.0.1:8765"}, {"origin": "http://evil.example"}
    refused(desk.post("/jobs/moon/cancel", headers=theirs), 403, "http://evil.example may not give orders")
    refused(desk.post("/jobs/moon/cancel", headers={"origin": "null"}), 403, "may not give orders")
    refused(desk.post("/jobs/moon/cancel", headers=ours), 404, "no job 'moon'")
    assert desk.get("/tasks", headers=theirs).headers.get("access-control-allow-origin") is None


# the description


def test_the_description_is_as_it_was(desk: Desk) -> None:
    live = openapi.text(desk.send("GET", "/openapi.json").json())
    assert live == openapi.FILE.read_text(), "the API has changed; if it should: python -m tests.contract.openapi"


def test_the_client_s_models_are_those_of_the_description(desk: Desk) -> None:
    live = client_models.text(desk.send("GET", "/openapi.json").json())
    assert live == client_models.FILE.read_text(), "generate them anew: python -m tests.contract.openapi"


def test_every_resource_is_described_with_its_refusals(desk: Desk) -> None:
    description = desk.send("GET", "/openapi.json").json()
    assert desk.send("GET", "/docs").status_code == 200
    for path, methods in description["paths"].items():
        for method, operation in methods.items():
            assert len(operation["description"]) > 10, (method, path)
            assert any(status.startswith("2") for status in operation["responses"]), (method, path)
            for status, response in operation["responses"].items():
                if status[0] in "45":
                    assert response["content"]["application/problem+json"]["schema"]["$ref"].endswith("/Refusal")


def test_no_answer_is_described_as_just_an_object(desk: Desk) -> None:
    description = desk.send("GET", "/openapi.json").json()
    for path, methods in description["paths"].items():
        for method, operation in methods.items():
            answers = [answer for status, answer in operation["responses"].items() if status.startswith("2")]
            for kind, content in (pair for answer in answers for pair in answer.get("content", {}).items()):
                schema = json.dumps(content["schema"])
                assert "binary" in schema or "$ref" in schema or "number" in schema, (method, path, kind)
    assert all("properties" in model or "enum" in model for model in description["components"]["schemas"].values())


# whatever comes

TEXT = st.text(st.characters(), max_size=20)  # with halves of surrogate pairs
WORD = st.one_of(st.sampled_from(["fuzz", "fuzz-2", "..", "x" * 65, "stop"]), st.text(max_size=20))
ANY_JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | TEXT,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=6,
)
FIELDS = st.sampled_from(
    ["task", "tracker", "plan", "path", "run", "clusters", "override", "kind", "settings", "scene", "calibration"]
)


@settings(max_examples=300, deadline=None)
@given(pick=st.integers(0, 10_000), words=st.tuples(WORD, WORD), body=st.dictionaries(FIELDS, ANY_JSON))
def test_whatever_is_sent_is_answered_without_a_fault(
    desk: Desk, pick: int, words: tuple[str, str], body: dict[str, Any]
) -> None:
    paths = desk.station.web.openapi()["paths"]
    operations = [(method.upper(), path) for path, methods in paths.items() for method in methods]
    method, path = operations[pick % len(operations)]
    for word in words:
        path = re.sub(r"\{\w+\}", lambda _, word=word: quote(word, safe=""), path, count=1)
    answer = desk.send(method, path, content=json.dumps(body), headers={"content-type": "application/json"})
    assert answer.status_code != 500, (method, path, body, answer.text)
    if answer.status_code >= 400:
        assert isinstance(answer.json()["detail"], str)
