"""The cookies of sessions: to no other site, not readable by scripts, and over TLS to no other host or path."""

from __future__ import annotations

from typing import Final

from fastapi import Response
from starlette.requests import HTTPConnection

from teachpath.access.loopback import host_of, is_loopback
from teachpath.errors import NotAllowed, NotSignedIn

SESSION: Final = "teachpath-session"
SIGN_IN: Final = "teachpath-sign-in"  # while a person is at the provider
HOST: Final = "__Host-"  # before its name: browsers take the cookie over TLS alone, of this host alone
SECURE_COOKIE: Final = HOST + SESSION
LOOPBACK_COOKIE: Final = SESSION  # on http of loopback, where no other machine hears it


def read_cookie(connection: HTTPConnection, kind: str = SESSION) -> str:
    """Return the secret of a cookie of a request; empty where it has none.

    Raises:
        NotSignedIn: it has several, so that somebody else may have set one of them.
    """
    if not (headers := connection.headers.getlist("cookie")):
        return ""
    name = _name(connection, kind)
    pairs = [pair.strip().partition("=") for header in headers for pair in header.split(";")]
    found = [value for key, _, value in pairs if key == name]
    if len(found) > 1:
        raise NotSignedIn(f"the request has {len(found)} cookies {name}; remove the cookies of this host and sign in")
    return found[0] if found else ""


def set_cookie(
    connection: HTTPConnection, response: Response, secret: str, *, seconds: float, kind: str = SESSION
) -> None:
    """Give a cookie to a browser, for at most so many seconds."""
    response.set_cookie(
        _name(connection, kind),
        secret,
        max_age=round(seconds),
        path="/",
        secure=_is_secure(connection),
        httponly=True,
        samesite="strict",
    )


def clear_cookie(connection: HTTPConnection, response: Response, kind: str = SESSION) -> None:
    """Take a cookie from a browser."""
    response.delete_cookie(
        _name(connection, kind), path="/", secure=_is_secure(connection), httponly=True, samesite="strict"
    )


def require_private_line(connection: HTTPConnection) -> None:
    """Raise NotAllowed where a password would be readable on the way: over http, but for this machine itself."""
    host = host_of(connection.headers.get("host", ""))
    client = connection.client.host if connection.client else ""
    if not _is_secure(connection) and not (is_loopback(host) and is_loopback(client)):
        raise NotAllowed(
            f"nobody signs in at http://{host[:80]}, where others could read the password; use https (a proxy says so "
            "by X-Forwarded-Proto), or this machine's own browser"
        )


def _is_secure(connection: HTTPConnection) -> bool:
    return connection.url.scheme in ("https", "wss")


def _name(connection: HTTPConnection, kind: str) -> str:
    return HOST + kind if _is_secure(connection) else kind
