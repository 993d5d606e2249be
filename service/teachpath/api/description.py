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

DESCRIPTION: Final = """Show a task a few times; teachpath finds the different ways it was done, learns a path for
each, proves that the arm can follow it, and moves the arm.

**From files to a motion.** `PUT /tasks/{task}` with `{"scene": "empty"}` (`paper` unless said; of a task that an
import makes `empty`); `POST /tasks/{task}/demonstrations` with each file as the body, then `POST /tasks/{task}/jobs`
with `{"kind": "learn"}`: each answers with a job. What learning has made is the run that the job's `outcome` names
(`GET /tasks/{task}/runs/{run}`, paths in `learned.paths`). `POST /paths/{path}/plans` makes a job, too, whose outcome
is a plan or `failure`, why there is none. `POST /executions` with `{"plan": ID}` moves the arm;
`GET /executions/{execution}` says how far it is: `status.state` is `ended` or `faulted` at last, with `reason`.
`POST /stop` stops the arm, and needs no token.

**Units.** Metres, radians, seconds; quaternions w, x, y, z; times ending in `_ns` are nanoseconds since the Unix
epoch. These have more digits than JavaScript's numbers: read them as BigInt (`JSON.parse` with a reviver whose third
argument has `source`, as in clients/examples/07_teach_from_typescript.ts).

**What is not there** is `null`; of a text it is the empty text, of a time in `_ns` it is 0. A field that is left out
of a request has its default.

**Jobs** are answered with 202 and their address in `Location`. Ask until `finished_ns` is not 0, or hear the topic
`jobs` of the WebSocket `/api/v1/events` (`/asyncapi.json`). An order with `Idempotency-Key` may be sent again where no
answer came: it begins nothing, and is answered with its job; with another order the key is refused (409).

**Lists** come in pages of at most `limit` entries; the header `Link` has the address of the next one (`rel="next"`).

**Refusals** are `application/problem+json`: `detail` is a sentence for people, `error` a word for programs. 404 is of
the address, 422 of the body or a parameter; a field or parameter that is not known is refused with the nearest known
name, and nothing is done. 429 has `Retry-After` in seconds. `HEAD` is answered wherever `GET` is.

**Who sends** is said by `Authorization: Bearer TOKEN` where the station asks (`GET /identity`). `Teachpath-Operator`
is a name beside that, for the journal; `Teachpath-Lease` the token of who has taken control (`POST /lease`), needed
only while somebody has. Programs send no `Origin`: it is how browsers tell pages of others."""
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
    "tracker": "name of the tracker",
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
