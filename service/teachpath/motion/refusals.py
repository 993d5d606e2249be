"""Says why something is refused, and tries one option after the other until one is not."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Final, TypeVar

from teachpath.errors import PathRefused
from teachpath.records import Failure, Vector

Option = TypeVar("Option")
Result = TypeVar("Result")

DIRECTION_WORDS: Final = (("away from the robot", "towards the robot"), ("to the left", "to the right"), ("up", "down"))
NAMED_COMPONENT_SHARE: Final = 0.45  # of the largest component of a move, from which another one is named too


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


def refusal(failure: Failure) -> PathRefused:
    """Return the error that tells of a failure."""
    return PathRefused(describe(failure), failure)


def describe(failure: Failure) -> str:
    """Describe in one sentence why a path fails, and what to change."""
    begin, end = failure.interval
    over = f" (it fails from s = {begin:.3f} to {end:.3f} m)" if end > begin else ""
    return f"{failure.reason}{over}; {failure.suggestion.sentence}"


def describe_direction(move: Vector) -> str:
    """Describe the direction of a move in words, as seen from the robot."""
    largest = max(abs(v) for v in move)
    named = sorted(
        (-abs(value), words[0] if value > 0 else words[1])
        for value, words in zip(move, DIRECTION_WORDS, strict=True)
        if abs(value) >= NAMED_COMPONENT_SHARE * largest
    )
    return " and ".join(words for _, words in named)
