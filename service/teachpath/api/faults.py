"""Errors as answers: the one table from the error tree to HTTP status codes."""

from __future__ import annotations

from fastapi import FastAPI, Request
from fastapi.responses import JSONResponse

from teachpath.errors import (
    Conflict,
    LearningFailed,
    NotFound,
    PathRefused,
    TeachpathError,
    Unreachable,
    UnusableInput,
)

STATUS: dict[type[TeachpathError], int] = {
    NotFound: 404,
    Conflict: 409,
    UnusableInput: 422,
    LearningFailed: 422,
    PathRefused: 422,
    Unreachable: 503,
}


def status_of(error: TeachpathError) -> int:
    """Return the HTTP status of an error: that of the nearest ancestor in the table."""
    return next((STATUS[kind] for kind in type(error).__mro__ if kind in STATUS), 500)


def answer_errors(app: FastAPI) -> None:
    """Let `app` answer teachpath's errors with their sentence in `detail`."""

    @app.exception_handler(TeachpathError)
    async def answer(_: Request, error: TeachpathError) -> JSONResponse:
        return JSONResponse({"detail": str(error), "error": type(error).__name__}, status_of(error))
