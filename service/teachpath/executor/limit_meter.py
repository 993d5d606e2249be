"""Measures how much of the limits of joints and tool the sent setpoints use."""

from __future__ import annotations

from collections import deque
from typing import Final, Protocol

import numpy as np

from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.tool_speed import monitored_points, point_names
from teachpath.records import Array

_NAMES: Final = ("speed", "acceleration", "jerk")


class HasLocation(Protocol):
    """Something that can tell its location."""

    @property
    def location(self) -> str:
        """Where it is, in words."""


class LimitMeter:
    """Compares first, second and third differences of setpoints with the limits of speed, acceleration and jerk.

    Where the speed of the tool is limited, the first differences of elbow, wrist and tool are compared with that, too.

    Args:
        rate: setpoints a second [Hz].
        start_q: (joints,) where the arm rests at the beginning [rad].
        arm: whose limits they are.
        previous: a meter whose largest use is kept; used when the arm was moved by hand since.

    Attributes:
        max_use: largest share of a limit so far.
        max_use_location: which limit that was, and where, in words.
    """

    def __init__(self, rate: float, start_q: Array, arm: Arm, previous: LimitMeter | None = None) -> None:
        limits = arm.limits.motion
        self._arm, self._rate = arm, rate
        self._names = arm.limits.names
        self._tool_speed = limits.tool_speed
        self._points = monitored_points(start_q, arm)
        self._scale = np.array([rate, rate**2, rate**3])[:, None] / np.stack(
            [limits.speed, limits.acceleration, limits.jerk]
        )  # (3, joints)
        self._last: deque[Array] = deque([start_q] * 3, maxlen=3)  # newest last
        self.max_use: float = previous.max_use if previous else 0.0
        self.max_use_location: str = previous.max_use_location if previous else ""

    def add(self, position: Array, where: HasLocation) -> None:
        """Measure the setpoint `position` (joints,) [rad]; when it uses most so far, keep the location of `where`."""
        third, second, first = self._last
        differences = np.stack(
            [position - first, position - 2 * first + second, position - 3 * first + 3 * second - third]
        )
        self._last.append(position)
        use = np.abs(differences) * self._scale
        worst = int(np.argmax(use))
        if use.flat[worst] > self.max_use:
            kind, joint = divmod(worst, len(self._names))
            self.max_use = float(use.flat[worst])
            self.max_use_location = f"{_NAMES[kind]} of {self._names[joint]} {where.location}"
        if self._tool_speed < np.inf:
            self._add_tool(position, where)

    def _add_tool(self, position: Array, where: HasLocation) -> None:
        points = monitored_points(position, self._arm)
        use = np.linalg.norm(points - self._points, axis=1) * self._rate / self._tool_speed
        self._points = points
        worst = int(np.argmax(use))
        if use[worst] > self.max_use:
            self.max_use = float(use[worst])
            self.max_use_location = f"speed of {point_names(self._arm)[worst]} {where.location}"
