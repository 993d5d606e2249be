"""Errors as answers: the table from the error tree to HTTP status codes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response
from fastapi.routing import iter_route_contexts
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.routing import Match

from teachpath.api.access import require_access
from teachpath.api.problems import FAULT_KIND, HTTP_KINDS, KINDS, REFUSED_KIND, Fault, printable, refuse
from teachpath.api.strict_requests import EXTRA_FIELD, unknown_field
from teachpath.errors import (
    Conflict,
    LearningFailed,
    NotAllowed,
    NotFound,
    NotSignedIn,
    OverLimit,
    PathRefused,
    QueueFull,
    StorageFull,
    StorageUnavailable,
    TeachpathError,
    TooManyRequests,
    Unreachable,
    UnusableInput,
)
from teachpath.io.store.faults import storage_fault

MAX_FAULTS: Final = 20  # fields that a refusal lists

STATUS: dict[type[TeachpathError], int] = {
    NotSignedIn: 401,
    NotAllowed: 403,
    TooManyRequests: 429,
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


def status_of(error: TeachpathError) -> int:
    """Return the HTTP status of an error: that of the nearest ancestor in the table."""
    return next((STATUS[kind] for kind in type(error).__mro__ if kind in STATUS), 500)


def kind_of(error: TeachpathError) -> str:
    """Return the word for an error: that of the nearest ancestor in the tree."""
    return next(kind.__name__ for kind in type(error).__mro__ if kind.__name__ in KINDS)


def answer_to(error: TeachpathError) -> Response:
    """Return the answer that an error is."""
    answer = refuse(status_of(error), str(error), kind_of(error), **_evidence(error))
    if isinstance(error, NotSignedIn):
        answer.headers["WWW-Authenticate"] = "Bearer"
    if isinstance(error, TooManyRequests | QueueFull):
        answer.headers["Retry-After"] = str(math.ceil(error.wait))
    return answer


def answer_errors(app: FastAPI) -> None:
    """Let `app` answer every error with a sentence in `detail`."""

    @app.exception_handler(TeachpathError)
    async def answer(_: Request, error: TeachpathError) -> Response:
        """Answer with the sentence and the status of an error of ours."""
        return answer_to(error)

    @app.exception_handler(RequestValidationError)
    async def name_fields(request: Request, error: RequestValidationError) -> Response:
        """Answer 422 with each wrong field, its place and what it may be; 404 where the address itself is wrong.

        Who may not ask at all is told that.
        """
        try:
            await require_access(request)  # FastAPI reads parameters and bodies first
        except (NotSignedIn, NotAllowed) as refusal:
            return await answer(request, refusal)
        errors = error.errors()
        faults = [_fault(request, e) for e in errors[:MAX_FAULTS]]
        sentence = f"{faults[0].place}: {faults[0].fault}" + (f", and {len(errors) - 1} more" if errors[1:] else "")
        if not _has_words(request.scope["route"], request.path_params):
            if _allowed(request):
                return await name_place(request, HTTPException(405))
            return refuse(404, sentence, "NotFound", errors=faults)
        return refuse(422, sentence, "UnusableInput", errors=faults)

    @app.exception_handler(HTTPException)
    async def name_place(request: Request, error: HTTPException) -> Response:
        """Answer an unknown address, a wrong method and the like in a sentence that names the way out."""
        headers = dict(error.headers or {})
        if error.status_code == 405:
            methods = _allowed(request)
            error, headers = HTTPException(405 if methods else 404), {"Allow": ", ".join(methods)} if methods else {}
        if error.status_code == 400:  # of a body, which FastAPI reads first
            try:
                await require_access(request)
            except (NotSignedIn, NotAllowed) as refusal:
                return await answer(request, refusal)
        kind = HTTP_KINDS.get(error.status_code, REFUSED_KIND)
        return refuse(error.status_code, _sentence(request, headers, error), kind, headers=headers)

    @app.exception_handler(UnicodeEncodeError)
    async def name_text(_: Request, error: UnicodeEncodeError) -> Response:
        """Answer 422 for a text that no file and no database can hold."""
        sentence = f"the text {error.object[:80]!r} holds half of a surrogate pair; send whole characters"
        return refuse(422, sentence, "UnusableInput")

    @app.exception_handler(ClientDisconnect)
    async def note_break(_: Request, __: ClientDisconnect) -> Response:
        """Answer 400 where a body broke off; nobody may hear it, but the log has no fault of ours."""
        return refuse(400, "the request broke off before its end; send it again", HTTP_KINDS[400])

    @app.exception_handler(OSError)
    async def name_disk(_: Request, error: OSError) -> Response:
        """Answer 507 for a full disk, and the like; raises the error again where storage has no part in it."""
        if (fault := storage_fault(error, "the data folder")) is None:
            raise error
        return refuse(status_of(fault), str(fault), kind_of(fault))

    @app.exception_handler(Exception)
    async def confess(_: Request, error: Exception) -> Response:
        """Answer 500 for an error that nobody thought of."""
        # the server logs the error itself, with its traceback
        return refuse(500, f"this is a fault of teachpath, please report it: {error!r}", FAULT_KIND)


def _evidence(error: TeachpathError) -> dict[str, Any]:
    """Return the records that an error carries."""
    return {name: getattr(error, name) for name in ("newer", "failure", "demonstration") if hasattr(error, name)}


def _fault(request: Request, error: dict[str, Any]) -> Fault:
    place = ".".join(str(piece) for piece in error["loc"])
    if error["type"] == "json_invalid":
        return Fault(place="body", fault=f"this is no JSON: {error['ctx']['error']} at character {error['loc'][-1]}")
    if error["type"] == EXTRA_FIELD:
        return Fault(place=printable(place), fault=printable(unknown_field(request, error["loc"])))
    return Fault(place=printable(place), fault=printable(error["msg"]).replace("Input should", "it should"))


def _allowed(request: Request) -> list[str]:
    """Return the methods of all routes at the address."""
    found = [route for route in iter_route_contexts(request.app.routes) if _is_at(route, request)]
    methods = {method for route in found for method in getattr(route, "methods", None) or ()}
    return sorted(methods | ({"HEAD"} if "GET" in methods else set()))


def _is_at(route: Any, request: Request) -> bool:
    """Tell whether an address is a route's, with words that it takes: `recording` is no verb of an execution."""
    match, child = route.matches(request.scope)
    return match is Match.PARTIAL and _has_words(route, child["path_params"])


def _has_words(route: Any, named: Mapping[str, Any]) -> bool:
    fields = route.dependant.path_params if hasattr(route, "dependant") else ()
    return not any(field.validate(named[field.alias], {}, loc=())[1] for field in fields)


def _sentence(request: Request, headers: dict[str, str], error: HTTPException) -> str:
    place = f"{request.method} {request.url.path}"
    if error.status_code == 404:
        return f"there is nothing at {place}; the resources are listed at /docs"
    if error.status_code == 405:
        return f"{place} is not possible; allowed here: {headers['Allow']}"
    if error.status_code == 400:
        return f"the body of {place} is no JSON that can be read: not UTF-8, nested too deeply, or a number is too long"
    return str(error.detail)
