"""The description of the API in OpenAPI: what FastAPI finds, and beside it what the records and the refusals say."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any, Final

from fastapi import FastAPI
from fastapi.routing import iter_route_contexts

from teachpath.api.examples import add_examples
from teachpath.api.problems import MEANINGS, PROBLEM, Refusal
from teachpath.api.schemas import REFERENCE, Schema, describe, records_in

TAGS: Final = {
    "tasks": "What is demonstrated, its demonstrations, and files that become some.",
    "recording": "Demonstrations that are being shown to a tracker now.",
    "exports": "Demonstrations as files.",
    "calibrations": "How the frames of trackers lie in the world.",
    "jobs": "Learning, planning and imports, which take a while: they are queued, and watched.",
    "results": "What jobs have made: learning runs, learned paths and certified plans.",
    "versions": "Edited and adapted versions of learned paths; none is ever overwritten.",
    "curves": "Operations on a curve that store nothing.",
    "executions": "The arm moves along a certified plan or follows a live hand; and the stop.",
    "programs": "Motions as files for other programs and robots.",
    "control": "Who may command the arm, who did what, and certificates that are taken back.",
    "robot": "How the arm is built, and how it would move.",
    "station": "Health, scenes, and where their objects lie.",
    "access": "Who one is, sessions of people and tokens of programs.",
}
PATH_PARAMETERS: Final = {
    "action": "what to do about control",
    "demonstration": "id of the demonstration",
    "execution": "id of the execution",
    "first": "number of the version that is compared with",
    "job": "id of the job",
    "name": "of what is addressed",
    "number": "of the version, from 1",
    "operation": "what to do to the curve",
    "path": "id of the learned path",
    "plan": "id of the plan",
    "run": "id of the learning run",
    "scene": "name of the scene",
    "second": "number of the version that is compared",
    "task": "name of the task",
    "verb": "what the arm does on its path",
}
ALWAYS_ANSWERED: Final = {"stop_execution", "stop_arm"}  # whatever comes with the request
LINK: Final[dict[str, Any]] = {"Link": {"description": "the next page, rel=next", "schema": {"type": "string"}}}
HEADERS_OF_REFUSALS: Final[dict[str, Any]] = {
    "401": {"WWW-Authenticate": {"description": "how to say who one is", "schema": {"type": "string"}}},
    "429": {"Retry-After": {"description": "seconds after which to try again", "schema": {"type": "integer"}}},
}


class DescribedApi(FastAPI):
    """A web application whose description is complete: every field has a text, every operation its own refusals."""

    _described: dict[str, Any] | None = None

    def openapi(self) -> dict[str, Any]:
        """Return the description in OpenAPI 3.1."""
        if self._described is None:
            document = copy.deepcopy(super().openapi())
            document["tags"] = [{"name": name, "description": text} for name, text in TAGS.items()]
            _add_refusal(document["components"]["schemas"])
            describe(document["components"]["schemas"], records_in(_types(self)))
            add_examples(document["components"]["schemas"])
            for path, methods in document["paths"].items():
                for method, operation in methods.items():
                    _describe_operation(path, method, operation)
            self._described = document
        return self._described


def _types(app: FastAPI) -> Iterator[Any]:
    """Yield the types of the bodies and answers of all routes."""
    yield Refusal
    for route in iter_route_contexts(app.routes):
        body = getattr(route, "body_field", None)
        yield from (getattr(route, "response_model", None), body and body.field_info.annotation)


def _add_refusal(schemas: dict[str, Schema]) -> None:
    """Put the form of refusals into the description instead of FastAPI's own."""
    described = Refusal.model_json_schema(ref_template=REFERENCE)
    schemas |= described.pop("$defs") | {"Refusal": described}
    for name in ("HTTPValidationError", "ValidationError"):
        schemas.pop(name, None)


def _describe_operation(path: str, method: str, operation: Schema) -> None:
    responses = operation["responses"]
    for parameter in operation.get("parameters", []):
        if parameter["in"] == "path" and "description" not in parameter:
            parameter["description"] = PATH_PARAMETERS.get(parameter["name"], "")
        if parameter["name"] == "after":
            responses["200"]["headers"] = LINK
    operation.setdefault("security", [])  # said, that it asks nobody who he is
    refused = {status: _refusal(status) for status in sorted(_refusals(path, method, operation))}
    operation["responses"] = {code: said for code, said in responses.items() if code < "400"} | refused


def _refusals(path: str, method: str, operation: Schema) -> set[str]:
    """Return with which statuses an operation may be refused: those that it declares, and those that its form has."""
    declared = {status for status in operation["responses"] if status >= "400"}
    by_form = {
        "400": "application/json" in operation.get("requestBody", {}).get("content", {}),
        "401": bool(operation["security"]),
        "403": bool(operation["security"]) or method != "get",  # a page of another origin
        "404": "{" in path,
        "408": "requestBody" in operation,
        "413": "requestBody" in operation,
        "422": True,  # a parameter that it does not have
        "429": True,
        "503": True,
    }
    found = declared | {status for status, holds in by_form.items() if holds}
    return found - {"422", "429"} if operation["operationId"] in ALWAYS_ANSWERED else found


def _refusal(status: str) -> Schema:
    described: Schema = {
        "description": MEANINGS[int(status)],
        "content": {PROBLEM: {"schema": {"$ref": REFERENCE.format(model="Refusal")}}},
    }
    if status in HEADERS_OF_REFUSALS:
        described["headers"] = HEADERS_OF_REFUSALS[status]
    return described
