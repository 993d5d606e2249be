"""Where the ways to rest of the newest setpoints end: there an arm rests that followed one."""

from __future__ import annotations

from collections import deque
from typing import Final

from teachpath.motion.execution.segments import RestPoint

MAX_AGE: Final = 4.0  # [s] for which it is known where the way to rest of a setpoint ends


class RestPoints:
    """Keeps the ends of the ways to rest; the first setpoint of a standstill stands for all of it.

    Args:
        rate: setpoints a second [Hz].
    """

    def __init__(self, rate: float) -> None:
        self._points: deque[tuple[int, RestPoint]] = deque(maxlen=round(MAX_AGE * rate))
        self._is_still = False  # the newest setpoint

    def add(self, cycle: int, point: RestPoint, *, is_still: bool) -> None:
        """Keep where the way to rest of the setpoint of `cycle` ends; `is_still`: that setpoint itself rests."""
        if not (is_still and self._is_still):
            self._points.append((cycle, point))
        self._is_still = is_still

    def find(self, cycle: int) -> RestPoint | None:
        """Return where the way to rest of the setpoint of `cycle` ends, or None when that is too long ago."""
        return next((point for number, point in reversed(self._points) if number <= cycle), None)
