"""Checks whether the setpoints of a ramp, joined to those already sent, keep all limits (compiled; see `kernels`).

An arm plays the motion between setpoints, too, by the quintic that meets both, and begins its own clock at any moment.
So what is checked are differences over control periods that begin at `PHASES` moments of a period.
"""

from __future__ import annotations

from math import ceil, inf, isfinite
from typing import Final

import numpy as np

from teachpath.motion.arm.puma560 import Array
from teachpath.motion.timing.kernels import evaluate_motion, evaluate_ramp, kernel

ACCEPTED_LIMIT_USE: Final = 0.997  # share of acceleration and jerk limits up to which a ramp is accepted
TRAILING_SETPOINTS: Final = 4  # after the end of a ramp, whose differences still depend on it
PHASES: Final = 8  # moments of a control period, in which the limits are checked
MAX_RAMP_PERIODS: Final = 5000  # of a ramp

# What `check_ramp` answers.
LIMITS_KEPT: Final = 0
SPEED_BROKEN: Final = 1
ACCELERATION_BROKEN: Final = 2
JERK_BROKEN: Final = 3


@kernel
def check_ramp(table: Array, step: float, ramp: Array, sent: Array, limits: Array, dt: float) -> tuple[int, float]:
    """Check the setpoints of a ramp, joined to those already sent, against the limits.

    Args:
        sent: (PHASES, 3, joints) see `advance`.
        limits: (3, joints) of first, second and third difference of setpoints [rad].
        dt: control period [s].

    Returns:
        Which limit is broken first, or LIMITS_KEPT, and how long after the beginning [s].
    """
    window, before, state, scale = sent.copy(), np.empty((3, table.shape[2])), np.empty(3), 1.0 / limits
    motion = np.empty_like(before)
    duration = ramp[3] + ramp[4] + ramp[5]
    if not 0.0 <= duration <= MAX_RAMP_PERIODS * dt:  # nor may it be no number
        return ACCELERATION_BROKEN, 0.0
    count = ceil(duration / dt) + TRAILING_SETPOINTS
    evaluate_motion(table, step, ramp[:3], motion)
    for k in range(1, count + 1):
        before, motion = motion, before
        state[0], state[1], state[2] = evaluate_ramp(ramp, k * dt)
        evaluate_motion(table, step, state, motion)
        speed, acceleration, jerk = advance(window, before, motion, dt, scale)
        if speed > 1.0:
            return SPEED_BROKEN, k * dt
        if acceleration > ACCEPTED_LIMIT_USE:
            return ACCELERATION_BROKEN, k * dt
        if jerk > ACCEPTED_LIMIT_USE:
            return JERK_BROKEN, k * dt
    return LIMITS_KEPT, 0.0


@kernel
def check_states(
    table: Array, step: float, begin: Array, states: Array, count: int, sent: Array, limits: Array, dt: float,
    uses: Array,
) -> bool:  # fmt: skip
    """Check the setpoints of states that end at rest, joined to those already sent, against the limits.

    Args:
        begin: (3,) tau, r and r' at the beginning.
        states: (n, 3) the same one period apart; the last of `count` rests.
        sent: (PHASES, 3, joints) see `advance`.
        limits: (3, joints) of first, second and third difference of setpoints [rad].
        dt: control period [s].
        uses: (n,) where the share is written that each setpoint uses of what is accepted, at most.
    """
    window, before, scale = sent.copy(), np.empty((3, table.shape[2])), 1.0 / limits
    motion = np.empty_like(before)
    most = 0.0
    uses[:count] = 0.0
    evaluate_motion(table, step, begin, motion)
    for k in range(count + TRAILING_SETPOINTS):
        before, motion = motion, before
        row = min(k, count - 1)
        evaluate_motion(table, step, states[row], motion)
        speed, acceleration, jerk = advance(window, before, motion, dt, scale)
        uses[row] = max(uses[row], speed, acceleration / ACCEPTED_LIMIT_USE, jerk / ACCEPTED_LIMIT_USE)
        most = max(most, uses[row])
    return most <= 1.0


@kernel
def advance(window: Array, begin: Array, end: Array, dt: float, scale: Array) -> tuple[float, float, float]:
    """Take a setpoint into the differences of those sent, and return its use of speed, acceleration and jerk limits.

    Joints that are no numbers use infinitely much.

    Args:
        window: (PHASES, 3, joints) joints at moments of the last period, the setpoint last, and their first and second
            differences over a period.
        begin: (3, joints + 1) motion at the last setpoint (see `evaluate_motion`).
        end: (3, joints + 1) motion at this one.
        dt: control period [s].
        scale: (3, joints) inverse limits of first, second and third difference [1/rad].
    """
    speed = acceleration = jerk = total = 0.0
    for i in range(window.shape[2]):
        p, v, a = begin[0, i], dt * begin[1, i], dt * dt * begin[2, i] / 2.0
        d, e, f = end[0, i] - p - v - a, dt * end[1, i] - v - 2.0 * a, dt * dt * end[2, i] / 2.0 - a
        third, fourth, fifth = 10.0 * d - 4.0 * e + f, -15.0 * d + 7.0 * e - 2.0 * f, 6.0 * d - 3.0 * e + f
        total += d + e + f
        for k in range(PHASES):
            x = (k + 1.0) / PHASES
            q = end[0, i] if k == PHASES - 1 else p + x * (v + x * (a + x * (third + x * (fourth + x * fifth))))
            one = q - window[k, 0, i]
            two = one - window[k, 1, i]
            speed = max(speed, abs(one) * scale[0, i])
            acceleration = max(acceleration, abs(two) * scale[1, i])
            jerk = max(jerk, abs(two - window[k, 2, i]) * scale[2, i])
            window[k, 0, i], window[k, 1, i], window[k, 2, i] = q, one, two
    if not isfinite(total):  # which no comparison above has seen
        return inf, inf, inf
    return speed, acceleration, jerk
