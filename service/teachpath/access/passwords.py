"""Passwords: Argon2id, and the same work whether or not somebody of that name is known."""

from __future__ import annotations

import unicodedata
from typing import Final

from argon2 import PasswordHasher
from argon2.exceptions import Argon2Error, InvalidHashError

from teachpath.errors import UnusableInput

MIN_LENGTH: Final = 10  # characters
MAX_LENGTH: Final = 256  # characters; a longer one would only cost time
# The second choice of RFC 9106: 64 MiB, three passes, four lanes; some 50 ms.
_HASHER: Final = PasswordHasher(time_cost=3, memory_cost=65536, parallelism=4)
# Of no password that anybody could send: it is longer than one may be.
_NOBODYS_HASH: Final = "$argon2id$v=19$m=65536,t=3,p=4$bm8gcGVyc29uJ3Mgc2FsdA$Y2hlY2tlZCBzbyB0aGF0IGl0IHRha2VzIHRpbWU"


def hash_password(password: str, name: str) -> str:
    """Return what is kept of a person's password.

    Raises:
        UnusableInput: it is too short, too long, or the name.
    """
    password = _normal(password)
    if not MIN_LENGTH <= len(password) <= MAX_LENGTH or password.casefold() == name.casefold():
        raise UnusableInput(
            f"this password cannot be used: take one of {MIN_LENGTH} to {MAX_LENGTH} characters that is not the name; "
            "four words that nobody would put together do well"
        )
    return _HASHER.hash(password)


def is_password(password: str, kept: str | None) -> bool:
    """Tell whether a password is the one of which something is kept; None: nobody's, after as much work."""
    password = _normal(password)[: MAX_LENGTH + 1]
    try:
        _HASHER.verify(kept or _NOBODYS_HASH, password)
    except (Argon2Error, InvalidHashError):
        return False
    return kept is not None and len(password) <= MAX_LENGTH


def _normal(password: str) -> str:
    # One keyboard writes an accent with its letter, another one behind it.
    return unicodedata.normalize("NFKC", password)
