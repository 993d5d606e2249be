"""The methods of every address: Allow says them all, HEAD answers as GET does, and a wrong word is a wrong address."""

import json
from typing import Any

import pytest

from tests.contract import openapi
from tests.contract.desk import API, Desk, refused
from tests.contract.test_strict_requests import address

PATHS: dict[str, dict[str, Any]] = json.loads(openapi.FILE.read_text())["paths"]
METHODS = ("DELETE", "GET", "OPTIONS", "PATCH", "POST", "PUT", "TRACE")


@pytest.mark.parametrize("path", PATHS)
def test_a_method_that_an_address_has_not_is_told_all_that_it_has(desk: Desk, path: str) -> None:
    place = address(path, next(iter(PATHS[path].values())))
    there = {method.upper() for method in PATHS[path]}
    allowed = ", ".join(sorted(there | ({"HEAD"} if "GET" in there else set())))
    for method in set(METHODS) - there:
        answer = desk.send(method, place)
        refused(answer, 405, f"{method} {place} is not possible; allowed here: {allowed}")
        assert answer.headers["allow"] == allowed


@pytest.mark.parametrize("name", ["%00", "%FF", "%ED%A0%80", "a%0Ab", "..%2Fapp.py", "x" * 5000])
@pytest.mark.parametrize("folder", ["web", "vendor", "help"])
def test_a_name_that_no_file_can_have_is_an_address_that_is_not_there(desk: Desk, folder: str, name: str) -> None:
    answer = desk.send("GET", f"/{folder}/{name}")
    assert answer.status_code == 404, answer.text


@pytest.mark.parametrize("path", [path for path, methods in PATHS.items() if "get" in methods])
def test_head_is_answered_as_get_is(desk: Desk, path: str) -> None:
    place = address(path, PATHS[path]["get"])
    get, head = desk.send("GET", place), desk.send("HEAD", place)
    assert (head.status_code, head.content) == (get.status_code, b"")
    assert head.headers.keys() == get.headers.keys()
    assert head.headers["content-type"] == get.headers["content-type"]


@pytest.mark.parametrize(
    ("resource", "sentence"),
    [
        ("/executions/moon/jump", "path.verb: it should be 'hold', 'resume' or 'reverse'"),
        ("/curves/twist", "path.operation: it should be 'insert-knot', 'remove-knot' or 'elevate'"),
        ("/lease/sell", "path.action: it should be"),
        ("/uploads/moon/examination", "path.upload"),
    ],
)
def test_a_wrong_word_in_an_address_is_no_fault_of_the_body(desk: Desk, resource: str, sentence: str) -> None:
    refused(desk.post(resource), 404, sentence)
    refused(desk.send("OPTIONS", API + resource), 404, "there is nothing at OPTIONS")


def test_an_address_without_a_method_is_no_address_with_a_wrong_word(desk: Desk) -> None:
    answer = desk.post("/executions/moon/program?format=csv")
    refused(answer, 405, "POST /api/v1/executions/moon/program is not possible; allowed here: GET, HEAD")
    refused(desk.post("/executions/moon/jump?format=csv"), 404, "query.format")


def test_a_version_is_a_number(desk: Desk) -> None:
    refused(desk.get("/paths/moon/versions/moon"), 404, "path.number")
