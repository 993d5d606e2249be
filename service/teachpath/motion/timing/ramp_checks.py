"""Checks whether the setpoints of a ramp, joined to those already sent, keep all limits (compiled; see `kernels`)."""

from __future__ import annotations

from math import ceil
from typing import Final

import numpy as np

from teachpath.motion.arm.puma560 import Array
from teachpath.motion.timing.kernels import compiled, evaluate_ramp, evaluate_table

ACCEPTED_LIMIT_USE: Final = 0.997  # share of acceleration and jerk limits up to which a ramp is accepted
TRAILING_SETPOINTS: Final = 4  # after the end of a ramp, whose differences still depend on it

# What `check_ramp` answers.
KEPT: Final = 0
SPEED_BROKEN: Final = 1
ACCELERATION_BROKEN: Final = 2
JERK_BROKEN: Final = 3


@compiled
def check_ramp(table: Array, step: float, ramp: Array, sent: Array, limits: Array, dt: float) -> tuple[int, float]:
    """Check the setpoints of a ramp, joined to those already sent, against the limits.

    Args:
        sent: (6, 6) see `advance`.
        limits: (3, 6) of first, second and third difference of setpoints [rad].
        dt: control period [s].

    Returns:
        Which limit is broken first, or KEPT, and how long after the beginning [s].
    """
    window, q, scale = sent.copy(), np.empty((2, 7)), 1.0 / limits
    count = ceil((ramp[3] + ramp[4] + ramp[5]) / dt) + TRAILING_SETPOINTS
    for k in range(1, count + 1):
        evaluate_table(table, step, evaluate_ramp(ramp, (k - 0.5) * dt)[0], q[0])
        evaluate_table(table, step, evaluate_ramp(ramp, k * dt)[0], q[1])
        speed, acceleration, jerk = advance(window, q, scale)
        if speed > 1.0:
            return SPEED_BROKEN, k * dt
        if acceleration > ACCEPTED_LIMIT_USE:
            return ACCELERATION_BROKEN, k * dt
        if jerk > ACCEPTED_LIMIT_USE:
            return JERK_BROKEN, k * dt
    return KEPT, 0.0


@compiled
def check_states(
    table: Array, step: float, begin: Array, states: Array, count: int, sent: Array, limits: Array, dt: float,
    uses: Array,
) -> bool:  # fmt: skip
    """Check the setpoints of states that end at rest, joined to those already sent, against the limits.

    Args:
        begin: (3,) tau, r and r' at the beginning.
        states: (n, 3) the same one period apart; the last of `count` rests.
        sent: (6, 6) see `advance`.
        limits: (3, 6) of first, second and third difference of setpoints [rad].
        dt: control period [s].
        uses: (n,) where the share is written that each setpoint uses of what is accepted, at most.
    """
    window, q, scale = sent.copy(), np.empty((2, 7)), 1.0 / limits
    most = 0.0
    uses[:count] = 0.0
    before = begin
    for k in range(count + TRAILING_SETPOINTS):
        row = min(k, count - 1)
        evaluate_table(table, step, midway(before, states[row], dt), q[0])
        evaluate_table(table, step, states[row, 0], q[1])
        before = states[row]
        speed, acceleration, jerk = advance(window, q, scale)
        uses[row] = max(uses[row], speed, acceleration / ACCEPTED_LIMIT_USE, jerk / ACCEPTED_LIMIT_USE)
        most = max(most, uses[row])
    return most <= 1.0


@compiled
def midway(begin: Array, end: Array, dt: float) -> float:
    """Return tau in the middle of a period between two states."""
    return float(0.5 * (begin[0] + end[0]) + 0.125 * dt * (begin[1] - end[1]))


@compiled
def advance(window: Array, q: Array, scale: Array) -> tuple[float, float, float]:
    """Take a setpoint into the differences of those sent, and return its use of speed, acceleration and jerk limits.

    An arm plays the motion between setpoints, too, and begins its own clock at any moment: so the third difference is
    limited for the places in the middle between setpoints as well.

    Args:
        window: (6, 6) newest setpoint, its first and second difference; the joints half a period before it, and their
            first and second difference.
        q: (2, n) joints half a period before the setpoint and at it [rad].
        scale: (3, 6) inverse limits of first, second and third difference [1/rad].
    """
    speed = acceleration = jerk = 0.0
    for i in range(6):
        first = q[1, i] - window[0, i]
        second = first - window[1, i]
        third = second - window[2, i]
        midway_first = q[0, i] - window[3, i]
        midway_second = midway_first - window[4, i]
        midway = midway_second - window[5, i]
        speed = max(speed, abs(first) * scale[0, i])
        acceleration = max(acceleration, abs(second) * scale[1, i])
        jerk = max(jerk, max(abs(third), abs(midway)) * scale[2, i])
        window[2, i], window[1, i], window[0, i] = second, first, q[1, i]
        window[5, i], window[4, i], window[3, i] = midway_second, midway_first, q[0, i]
    return speed, acceleration, jerk
