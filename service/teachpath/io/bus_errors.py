"""Errors as answers to queries on the bus: what the answering side raised is raised again where it was asked."""

from __future__ import annotations

import json

from teachpath import errors
from teachpath.errors import TeachpathError, Unreachable


def pack_error(error: TeachpathError) -> bytes:
    """Return an error as bytes, for whoever asked."""
    return json.dumps({"error": type(error).__name__, "message": str(error)}).encode()


def raise_again(payload: bytes, key: str) -> None:
    """Raise the error that was the answer on a key; Unreachable where it is none of ours."""
    try:
        body = json.loads(payload)
        kind = getattr(errors, body["error"])
        message = body["message"]
    except (ValueError, KeyError, TypeError, AttributeError):
        raise Unreachable(f"{key} answered with an error: {payload[:200]!r}") from None
    raise kind(message)
