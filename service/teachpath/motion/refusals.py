"""Tries one option after the other until one is not refused."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

from teachpath.errors import PathRefused

Option = TypeVar("Option")
Result = TypeVar("Result")


def first_accepted(options: Iterable[Option], attempt: Callable[[Option], Result]) -> Result:
    """Return the result of the first attempt that is not refused.

    Args:
        options: at least one, the best first.
        attempt: raises PathRefused for an option that cannot be used.

    Raises:
        PathRefused: every option was refused; this is the refusal of the first.
    """
    first_refusal: PathRefused | None = None
    for option in options:
        try:
            return attempt(option)
        except PathRefused as refusal:
            first_refusal = first_refusal or refusal
    assert first_refusal is not None
    raise first_refusal
