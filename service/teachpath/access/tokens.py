"""Tokens: random, shown once, and kept as a hash."""

from __future__ import annotations

import hashlib
import secrets
from typing import Final

from teachpath.records import AccessToken, Capability

PREFIX: Final = "teachpath-"  # by which scanners of published files find a token
SECRET_BYTES: Final = 32
MAX_LENGTH: Final = 128  # characters of anything that may be a token
DAY_NS: Final = 86_400 * 10**9


def new_token(name: str, roles: tuple[Capability, ...], *, now_ns: int, days: float) -> tuple[str, AccessToken]:
    """Make a token, and return it with what is kept of it."""
    token = PREFIX + new_secret()
    kept = AccessToken(name, roles, digest_of(token), created_ns=now_ns, expires_ns=now_ns + round(days * DAY_NS))
    return token, kept


def new_secret() -> str:
    """Return a random text that nobody guesses."""
    return secrets.token_urlsafe(SECRET_BYTES)


def digest_of(token: str) -> str:
    """Return the SHA-256 of a token (hex). It has 256 random bits: a slow hash would make nobody's guess slower."""
    return hashlib.sha256(token.encode(errors="surrogateescape")).hexdigest()
