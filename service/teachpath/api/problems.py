"""The form of every refusal: problem details after RFC 9457, and beside them what the records say."""

from __future__ import annotations

import inspect
import re
from http import HTTPStatus
from typing import Any, Final

from pydantic import BaseModel, Field
from starlette.responses import JSONResponse

from teachpath import errors
from teachpath.records import Failure, Version

PROBLEM: Final = "application/problem+json"
KINDS: Final = {
    name: kind
    for name, kind in vars(errors).items()
    if inspect.isclass(kind) and issubclass(kind, errors.TeachpathError)
}
UNNAMED_TYPE: Final = "about:blank"  # type of a refusal that says no more than its status
TYPES: Final = {name: f"urn:teachpath:error:{name}" for name in KINDS}

# Kinds of refusals that no error of the tree is: of HTTP alone, of the service as a whole, and of its faults.
HTTP_KINDS: Final = {
    400: "Bad Request",
    404: "Not Found",
    405: "Method Not Allowed",
    408: "Request Timeout",
    413: "Request Entity Too Large",
}
REFUSED_KIND: Final = "Refused"
FAULT_KIND: Final = "InternalError"
WORDS: Final = (*TYPES, *HTTP_KINDS.values(), REFUSED_KIND, FAULT_KIND)

# What a status says of any operation.
MEANINGS: Final = {
    400: "The body is no JSON that can be read.",
    401: "The station asks who sends this, and does not know.",
    403: "The sender may not do this, or it is a page of another origin.",
    404: "There is nothing at this address.",
    408: "The body comes too slowly.",
    409: "The thing is busy, already there, or has changed meanwhile.",
    413: "The body is too large.",
    422: "What came in cannot be used as it is, or names what is not there.",
    429: "The sender asks for too much at a time, too many jobs wait, or too many sign-ins have failed.",
    503: "A process of the station, its disk or its database does not answer.",
    507: "The disk is full.",
}


class Fault(BaseModel):
    """One field of a request that cannot be used."""

    place: str = Field(description="where it is, e.g. body.override")
    fault: str = Field(description="what is wrong with it, in words")


class Refusal(BaseModel):
    """Why a request was refused: problem details after RFC 9457."""

    type: str = Field(
        description="the kind of the error as a URI; about:blank where there is no more to say than the status",
        json_schema_extra={"enum": [UNNAMED_TYPE, *TYPES.values()]},
    )
    title: str = Field(description="the kind of the error in words, always the same")
    status: int = Field(description="of HTTP")
    detail: str = Field(description="a sentence for the operator: value, limit, place, way out")
    error: str = Field(description="kind of the error, a word for programs", json_schema_extra={"enum": [*WORDS]})
    errors: list[Fault] = Field(
        default=[], description="the unusable fields of the request, at most 20, when that is the reason"
    )
    newer: Version | None = Field(None, description="the version saved meanwhile, when that is the reason")
    failure: Failure | None = Field(None, description="where the path fails, why, and which control point to move")
    demonstration: str = Field("", description="id of the demonstration that is to blame")


def refusals(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return what a route declares of refusals that its form does not show, e.g. `responses=refusals(409)`."""
    return {status: {"description": MEANINGS[status]} for status in statuses}


def refuse(
    status: int, sentence: str, kind: str, *, headers: dict[str, str] | None = None, **evidence: Any
) -> JSONResponse:
    """Return a refusal as an answer.

    Args:
        status: of HTTP.
        sentence: for the operator.
        kind: of the error, e.g. `NotFound`.
        headers: of the answer.
        evidence: records for the further fields of a refusal.
    """
    title = re.split("[;.]", KINDS[kind].__doc__ or "")[0] if kind in KINDS else HTTPStatus(status).phrase
    refusal = Refusal(
        type=TYPES.get(kind, UNNAMED_TYPE),
        title=title,
        status=status,
        detail=printable(sentence),
        error=kind,
        **evidence,
    )
    document = refusal.model_dump(mode="json", exclude_defaults=True)
    return JSONResponse(document, status, headers, media_type=PROBLEM)


def printable(text: str) -> str:
    """Return a text that has a form in UTF-8, which half of a surrogate pair, that JSON may hold, has not."""
    return text.encode(errors="backslashreplace").decode()
