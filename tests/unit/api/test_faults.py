"""Errors as answers: the record that an error carries stands beside its sentence."""

import asyncio
import json
from typing import Any

import pytest
from fastapi import FastAPI, Request
from httpx import ASGITransport, AsyncClient
from starlette.types import Message

from teachpath.api.faults import answer_errors
from teachpath.errors import LearningFailed, Outdated, PathRefused, TeachpathError
from teachpath.records import Failure, Suggestion, Version

FAILURE = Failure("reach", 0.1, (0.1, 0.2), (0.5, 0.0, 0.5), "too far", Suggestion(3, (0.0, 0.0, -0.01), "lower it"))
VERSION = Version("path-1", 2, 1, "main", "", "Ada", "", 1)


def answered(error: TeachpathError) -> tuple[int, dict[str, Any]]:
    app = FastAPI()
    answer_errors(app)

    @app.get("/")
    def fail() -> None:
        raise error

    async def ask() -> tuple[int, dict[str, Any]]:
        async with AsyncClient(transport=ASGITransport(app), base_url="http://here") as client:
            answer = await client.get("/")
            return answer.status_code, answer.json()

    return asyncio.run(ask())


def test_a_body_that_breaks_off_is_no_fault_of_the_service() -> None:
    app, sent = FastAPI(), list[Message]()
    answer_errors(app)

    @app.post("/")
    async def read(request: Request) -> None:
        await request.body()

    async def gone() -> Message:
        return {"type": "http.disconnect"}

    async def send(message: Message) -> None:
        sent.append(message)

    scope = {"type": "http", "method": "POST", "path": "/", "query_string": b"", "headers": []}
    asyncio.run(app(scope, gone, send))
    assert sent[0]["status"] == 400
    assert "broke off" in json.loads(sent[1]["body"])["detail"]


PROBLEM = ("type", "title", "status")  # what every refusal has besides (RFC 9457)


@pytest.mark.parametrize(
    ("error", "status", "name", "record"),
    [
        (
            PathRefused("cannot", FAILURE),
            422,
            "failure",
            {
                "fault": "reach",
                "s": 0.1,
                "interval": [0.1, 0.2],
                "position": [0.5, 0.0, 0.5],
                "reason": "too far",
                "suggestion": {"control_point": 3, "move": [0.0, 0.0, -0.01], "sentence": "lower it"},
            },
        ),
        (LearningFailed("cannot", "demonstration-7"), 422, "demonstration", "demonstration-7"),
        (
            Outdated("newer", VERSION),
            409,
            "newer",
            {
                "path": "path-1",
                "number": 2,
                "parent": 1,
                "branch": "main",
                "name": "",
                "author": "Ada",
                "note": "",
                "created_ns": 1,
            },
        ),
    ],
)
def test_an_error_answers_with_its_record(error: TeachpathError, status: int, name: str, record: Any) -> None:
    found, document = answered(error)
    assert found == document["status"] == status
    assert {key: document[key] for key in document if key not in PROBLEM} == {
        "detail": str(error), "error": type(error).__name__, name: record,
    }  # fmt: skip


@pytest.mark.parametrize("error", [PathRefused("cannot"), LearningFailed("cannot")])
def test_an_error_without_a_record_answers_with_its_sentence(error: TeachpathError) -> None:
    found, document = answered(error)
    assert found == document["status"] == 422
    said = {"detail": "cannot", "error": type(error).__name__}
    assert {key: document[key] for key in document if key not in PROBLEM} == said
