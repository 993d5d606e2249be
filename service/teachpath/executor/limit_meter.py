"""Measures, on the setpoints as they are sent, how much of the joints' limits they use."""

from __future__ import annotations

from collections import deque
from typing import Final, Protocol

import numpy as np

from teachpath.motion.arm.puma560 import ACCELERATION, JERK, SPEED
from teachpath.records import Array

_LIMITS: Final = np.stack([SPEED, ACCELERATION, JERK])
_NAMES: Final = ("speed", "acceleration", "jerk")


class HasLocation(Protocol):
    """Something that can say in words where it is."""

    @property
    def location(self) -> str:
        """Where it is."""


class LimitMeter:
    """Re-differences setpoints: first, second and third difference against speed, acceleration and jerk limit.

    Args:
        rate: setpoints a second [Hz].
        here: (6,) where the arm rests at the beginning [rad].
        before: a meter whose largest use counts on; the arm was moved by hand since.
    """

    def __init__(self, rate: float, here: Array, before: LimitMeter | None = None) -> None:
        self._scale = np.array([rate, rate**2, rate**3])[:, None] / _LIMITS  # (3, 6)
        self._last: deque[Array] = deque([here] * 3, maxlen=3)  # newest last
        self.max_use: float = before.max_use if before else 0.0
        self.max_use_location: str = before.max_use_location if before else ""

    def add(self, position: Array, where: HasLocation) -> None:
        """Measure the setpoint `position` (6,) [rad]; its place is asked of `where` when it is the largest."""
        third, second, first = self._last
        differences = np.stack(
            [position - first, position - 2 * first + second, position - 3 * first + 3 * second - third]
        )
        self._last.append(position)
        use = np.abs(differences) * self._scale
        worst = int(np.argmax(use))
        if use.flat[worst] > self.max_use:
            kind, joint = divmod(worst, 6)
            self.max_use = float(use.flat[worst])
            self.max_use_location = f"{_NAMES[kind]} of joint {joint + 1} {where.location}"
