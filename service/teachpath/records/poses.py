"""Rules of poses and calibrations that come from outside: what is a rotation, and what is the same place."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from teachpath.errors import UnusableInput
from teachpath.records.arrays import Quaternion
from teachpath.records.calibrations import Calibration

MAX_NORM_ERROR: Final = 0.01  # of a quaternion that is brought to unit length
SAME_PLACE: Final = 0.001  # [m] within which an object that is seen again has not moved
SAME_TURN: Final = math.radians(1.0)  # likewise
SCALES: Final = (1e-4, 1e4)  # least and largest of a calibration; 0.001 is of a tracker in millimetres
MAX_OFFSET: Final = 100.0  # [m] of a calibration


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


def check_calibration(calibration: Calibration) -> None:
    """Raise UnusableInput where no tracker can be mapped to the world so."""
    unit_quaternion(calibration.rotation, "calibration.rotation")
    low, high = SCALES
    if not low <= calibration.scale <= high:
        raise UnusableInput(f"calibration.scale {calibration.scale:g} is outside {low:g} to {high:g}")
    if not max(map(abs, calibration.offset)) <= MAX_OFFSET:
        raise UnusableInput(f"calibration.offset {list(calibration.offset)} is over {MAX_OFFSET:g} m: is it in metres?")
