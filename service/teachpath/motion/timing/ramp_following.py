"""Follows the states of a ramp, one control period after the other (compiled; see `kernels`).

States are rows of plan time, its rate and the rate's derivative at the ends of the periods, up to the ramp's constant
rate; the last of them goes on at its rate.
"""

from __future__ import annotations

from math import ceil

import numpy as np

from teachpath.motion.arm.puma560 import Array
from teachpath.motion.timing.kernels import evaluate_motion, evaluate_ramp, kernel
from teachpath.motion.timing.ramp_checks import advance


@kernel
def sample_ramp(ramp: Array, dt: float, out: Array) -> int:
    """Write the states (n, 3) of a ramp at the end of each period, up to its constant rate; return n, or 0 if too many.

    Args:
        out: (m, 3) with room for them.
    """
    count = max(ceil((ramp[3] + ramp[4] + ramp[5]) / dt), 1)
    if count > out.shape[0]:
        return 0
    for k in range(count):
        out[k] = evaluate_ramp(ramp, (k + 1) * dt)
    return int(count)


@kernel
def state_after(states: Array, count: int, periods: int, dt: float) -> tuple[float, float, float]:
    """Return tau, r and r' after some periods of states (n, 3), of which the last of `count` goes on at its rate."""
    row = min(periods, count) - 1
    beyond = max(periods - count, 0) * dt
    return states[row, 0] + beyond * states[row, 1], states[row, 1], states[row, 2]


@kernel
def follow(
    table: Array, step: float, states: Array, count: int, begin: int, dt: float, sent: Array, state: Array, out: Array
) -> int:
    """Follow states, or as far as an end of the table, where the motion rests; return for how many periods.

    Args:
        states: (n, 3) see `state_after`; `begin` of them are done.
        sent: (PHASES, 3, joints) where the setpoints are taken in (see `advance`).
        state: (3,) the last state, which is overwritten.
        out: (m, 3, joints + 1) where the motion is written, one a period (see `evaluate_motion`).
    """
    motion = np.empty((3, table.shape[2]))
    evaluate_motion(table, step, state, motion)
    for k in range(out.shape[0]):
        ended = advance_along(table, step, states, count, begin + k + 1, dt, state, motion, sent)
        out[k] = motion
        if ended:
            return k + 1
    return len(out)


@kernel
def advance_along(
    table: Array, step: float, states: Array, count: int, done: int, dt: float, state: Array, motion: Array,
    sent: Array,
) -> bool:  # fmt: skip
    """Write state and motion (see `evaluate_motion`) after `done` periods of states; tell whether the table ends there.

    Args:
        states: (n, 3) see `state_after`.
        motion: (3, joints + 1) that of the period before, which is overwritten.
        sent: (PHASES, 3, joints) where the setpoint is taken in (see `advance`).
    """
    before, end = motion.copy(), (table.shape[0] - 1) * step
    state[0], state[1], state[2] = state_after(states, count, done, dt)
    ended = (state[0] >= end and state[1] >= 0.0) or (state[0] <= 0.0 and state[1] <= 0.0)
    if ended:
        state[0], state[1], state[2] = min(max(state[0], 0.0), end), 0.0, 0.0
    evaluate_motion(table, step, state, motion)
    advance(sent, before, motion, dt, np.ones(sent.shape[1:]))
    return bool(ended)
