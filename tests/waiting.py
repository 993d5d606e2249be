"""Waiting for a state: the limit only bounds a hang, so that no law depends on how fast a machine is."""

import time
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")

HANG = 300.0  # [s] after which what has not happened never will, on a machine however busy


def wait_until(true: Callable[[], T], what: str, *, pause: Callable[[float], object] = time.sleep) -> T:
    """Return what `true` returns as soon as that is true; fails with `what` when it never is."""
    deadline = time.monotonic() + HANG
    while not (result := true()):
        assert time.monotonic() < deadline, f"not within {HANG:g} s: {what}"
        pause(0.01)
    return result
