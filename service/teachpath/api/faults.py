"""Errors as answers: the table from the error tree to HTTP status codes, and the form of every refusal."""

from __future__ import annotations

from http import HTTPStatus
from typing import Any, Final

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel, Field
from starlette.exceptions import HTTPException

from teachpath.api.strict_requests import EXTRA_FIELD, unknown_field
from teachpath.errors import (
    Conflict,
    LearningFailed,
    NotFound,
    OverLimit,
    PathRefused,
    QueueFull,
    StorageFull,
    StorageUnavailable,
    TeachpathError,
    Unreachable,
    UnusableInput,
)
from teachpath.io.store.faults import storage_fault
from teachpath.records import Failure, Version

MAX_FAULTS: Final = 20  # fields that a refusal lists

STATUS: dict[type[TeachpathError], int] = {
    NotFound: 404,
    Conflict: 409,
    QueueFull: 429,
    UnusableInput: 422,
    LearningFailed: 422,
    PathRefused: 422,
    OverLimit: 422,
    StorageFull: 507,
    StorageUnavailable: 503,
    Unreachable: 503,
}


class Fault(BaseModel):
    """One field of a request that cannot be used."""

    place: str = Field(description="where it is, e.g. body.override")
    fault: str


class Refusal(BaseModel):
    """Why a request was refused."""

    detail: str = Field(description="a sentence for the operator: value, limit, place, way out")
    error: str = Field(description="kind of the error")
    errors: list[Fault] = Field(
        default=[], description="the unusable fields of the request, at most 20, when that is the reason"
    )
    newer: Version | None = Field(None, description="the version saved meanwhile, when that is the reason")
    failure: Failure | None = Field(None, description="where the path fails, why, and which control point to move")
    demonstration: str = Field("", description="id of the demonstration that is to blame")


# What any resource may answer instead of its outcome.
REFUSALS: Final[dict[int | str, dict[str, Any]]] = {
    403: {"model": Refusal, "description": "The request comes from a page of another origin."},
    404: {"model": Refusal, "description": "There is nothing of that name."},
    408: {"model": Refusal, "description": "The body comes too slowly."},
    409: {"model": Refusal, "description": "The thing is busy, already there, or has changed meanwhile."},
    413: {"model": Refusal, "description": "The body is too large."},
    422: {"model": Refusal, "description": "What came in cannot be used as it is."},
    429: {"model": Refusal, "description": "Too many jobs wait."},
    503: {"model": Refusal, "description": "A process of the station, its disk or its database does not answer."},
    507: {"model": Refusal, "description": "The disk is full."},
}


def status_of(error: TeachpathError) -> int:
    """Return the HTTP status of an error: that of the nearest ancestor in the table."""
    return next((STATUS[kind] for kind in type(error).__mro__ if kind in STATUS), 500)


def answer_errors(app: FastAPI) -> None:
    """Let `app` answer every error with a sentence in `detail`."""

    @app.exception_handler(TeachpathError)
    async def answer(_: Request, error: TeachpathError) -> JSONResponse:
        return _answer(status_of(error), str(error), type(error).__name__, **_evidence(error))

    @app.exception_handler(RequestValidationError)
    async def name_fields(request: Request, error: RequestValidationError) -> JSONResponse:
        errors = error.errors()
        faults = [_fault(request, e) for e in errors[:MAX_FAULTS]]
        sentence = f"{faults[0].place}: {faults[0].fault}" + (f", and {len(errors) - 1} more" if errors[1:] else "")
        return _answer(422, sentence, "UnusableInput", faults)

    @app.exception_handler(HTTPException)
    async def name_place(request: Request, error: HTTPException) -> JSONResponse:
        answer = _answer(error.status_code, _sentence(request, error), HTTPStatus(error.status_code).phrase)
        answer.headers.update(error.headers or {})
        return answer

    @app.exception_handler(UnicodeEncodeError)
    async def name_text(_: Request, error: UnicodeEncodeError) -> JSONResponse:
        sentence = f"the text {error.object[:80]!r} holds half of a surrogate pair; send whole characters"
        return _answer(422, sentence, "UnusableInput")

    @app.exception_handler(OSError)
    async def name_disk(_: Request, error: OSError) -> JSONResponse:
        if (fault := storage_fault(error, "the data folder")) is None:
            raise error
        return _answer(status_of(fault), str(fault), type(fault).__name__)

    @app.exception_handler(Exception)
    async def confess(_: Request, error: Exception) -> JSONResponse:
        # the server logs the error itself, with its traceback
        return _answer(500, f"this is a fault of teachpath, please report it: {error!r}", "InternalError")


def _answer(status: int, sentence: str, kind: str, faults: list[Fault] | None = None, **evidence: Any) -> JSONResponse:
    refusal = Refusal(detail=_printable(sentence), error=kind, errors=faults or [], **evidence)
    return JSONResponse(refusal.model_dump(mode="json", exclude_defaults=True), status)


def _evidence(error: TeachpathError) -> dict[str, Any]:
    """Return the records that an error carries."""
    return {name: getattr(error, name) for name in ("newer", "failure", "demonstration") if hasattr(error, name)}


def _fault(request: Request, error: dict[str, Any]) -> Fault:
    place = ".".join(str(piece) for piece in error["loc"])
    if error["type"] == "json_invalid":
        return Fault(place="body", fault=f"this is no JSON: {error['ctx']['error']} at character {error['loc'][-1]}")
    if error["type"] == EXTRA_FIELD:
        return Fault(place=_printable(place), fault=_printable(unknown_field(request, error["loc"])))
    return Fault(place=_printable(place), fault=_printable(error["msg"]).replace("Input should", "it should"))


def _sentence(request: Request, error: HTTPException) -> str:
    place = f"{request.method} {request.url.path}"
    if error.status_code == 404:
        return f"there is nothing at {place}; the resources are listed at /docs"
    if error.status_code == 405:
        return f"{place} is not possible; allowed here: {(error.headers or {}).get('Allow', 'nothing')}"
    return str(error.detail)


def _printable(text: str) -> str:
    # half of a surrogate pair, which JSON may hold, has no form in UTF-8
    return text.encode(errors="backslashreplace").decode()
