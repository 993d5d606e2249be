"""Rules of poses that come from outside: what is a rotation, and what is the same place."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from teachpath.errors import UnusableInput
from teachpath.records.arrays import Quaternion

MAX_NORM_ERROR: Final = 0.01  # of a quaternion that is brought to unit length
SAME_PLACE: Final = 0.001  # [m] within which an object that is seen again has not moved
SAME_TURN: Final = math.radians(1.0)  # likewise


def unit_quaternion(orientation: Sequence[float], what: str = "an orientation") -> Quaternion:
    """Return a quaternion w, x, y, z of length 1.

    Args:
        orientation: as it was given.
        what: it is, for the refusal, e.g. "goal.orientation".

    Raises:
        UnusableInput: it is no quaternion of a rotation.
    """
    norm = math.hypot(*orientation) if len(orientation) == 4 else math.nan
    if not abs(norm - 1) <= MAX_NORM_ERROR:
        given = ", ".join(f"{value:.6g}" for value in orientation)
        raise UnusableInput(
            f"[{given}] is no value of {what}: write a quaternion w, x, y, z of length 1 within {MAX_NORM_ERROR:g}"
            + (f"; this one has length {norm:.4g}: divide it by its length" if norm > 0 else "")
        )
    w, x, y, z = (value / norm for value in orientation)
    return w, x, y, z
