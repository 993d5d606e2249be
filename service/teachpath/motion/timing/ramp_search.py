"""Searches for short ramps of the rate of plan time whose setpoints keep all limits (compiled; see `kernels`)."""

from __future__ import annotations

from math import sqrt
from typing import Final

import numpy as np

from teachpath.motion.arm.puma560 import Array
from teachpath.motion.timing.kernels import kernel, shortest_ramp
from teachpath.motion.timing.ramp_checks import JERK_BROKEN, LIMITS_KEPT, SPEED_BROKEN, check_ramp

JERK_REDUCTION: Final = 0.6  # factor for the next trial after a broken jerk limit
ACCELERATION_REDUCTION: Final = 0.7  # factor for the next trial after a broken acceleration limit
MIN_TIME_SAVED: Final = 0.002  # s, by which a new ramp must be shorter than the present one
LOOKAHEAD_TIME: Final = 0.03  # s, over which the joints' speeds bound the first trial
RAMP_SHAPES: Final = (0.6, 0.35, 1.0, 0.2, 0.1, 0.05)  # that are tried to shorten a ramp (see `_shaped_ramp`)
REDUCTIONS: Final = (0.8, 0.93, 0.98)  # of a ramp's duration that are tried
SHAPE_ITERATIONS: Final = 5
MAX_RATE_ACCELERATION: Final = 1e4  # 1/s^2, of a ramp
MAX_RATE_JERK: Final = 1e6  # 1/s^3


@kernel
def find_ramp(
    table: Array, step: float, state: Array, target: float, sent: Array, limits: Array, dt: float, within: float,
    tries: int, max_rate: float, ramp: Array,
) -> float:  # fmt: skip
    """Search for the shortest ramp to the constant rate `target` within all limits; return its peak |r'|, or -1.

    The limit that a trial breaks, and when, tell what to reduce next: |r''| where the jerk limit breaks in the first or
    last phase, otherwise |r'|. After a ramp was found, the remaining trials lie halfway to those that broke a limit.

    Args:
        sent: (PHASES, 3, joints) see `ramp_checks.advance`.
        within: duration of the present ramp [s]; a new one must be shorter by `MIN_TIME_SAVED`.
        tries: ramps that are checked at most.
        max_rate: largest |r| that the limit of the tool's speed allows.
        ramp: (8,) where the best ramp is written.
    """
    steepest, hardest = _search_bounds(table, step, state, limits, dt)
    failed_a, failed_j, kept_a, kept_j, best = 0.0, 0.0, 0.0, 0.0, -1.0
    trial = np.empty(8)
    for _ in range(tries):
        peak = shortest_ramp(trial, state, target, steepest, hardest)
        if peak < 0.0 or trial[3] + trial[4] + trial[5] >= within - MIN_TIME_SAVED:
            return best
        if _largest_rate(trial) > max_rate:
            return best
        broken, when = check_ramp(table, step, trial, sent, limits, dt)
        if broken == SPEED_BROKEN:
            return best
        if broken == LIMITS_KEPT:
            best, within = peak, trial[3] + trial[4] + trial[5]
            ramp[:] = trial
            kept_a, kept_j = min(steepest, peak), hardest
            if failed_a == 0.0 and failed_j == 0.0:
                return best
            failed_a, failed_j = max(failed_a, kept_a), max(failed_j, kept_j)
        elif broken == JERK_BROKEN and not trial[3] <= when - 1.5 * dt <= trial[3] + trial[4]:
            failed_j, hardest = hardest, JERK_REDUCTION * hardest
        else:
            failed_a = min(steepest, peak)
            steepest = ACCELERATION_REDUCTION * failed_a
        if best >= 0.0:
            steepest, hardest = sqrt(kept_a * failed_a), sqrt(kept_j * failed_j)
    return best


@kernel
def shorten_ramp(
    table: Array, step: float, state: Array, target: float, sent: Array, limits: Array, dt: float, within: float,
    tries: int, max_rate: float, ramp: Array,
) -> float:  # fmt: skip
    """Search for a ramp to the constant rate `target` within all limits that is shorter; return its peak |r'|, or -1.

    Ramps of several shapes are tried, at first much shorter ones. A shape that breaks a limit is left for the next one,
    a reduction with which every shape does for a smaller one.

    Args:
        sent: (PHASES, 3, joints) see `ramp_checks.advance`.
        within: duration of the present ramp [s]; a new one must be shorter by `MIN_TIME_SAVED`.
        tries: ramps that are checked at most.
        max_rate: largest |r| that the limit of the tool's speed allows.
        ramp: (8,) where the best ramp is written, if any.
    """
    trial, best = np.empty(8), -1.0
    shape = failed = reduction = 0
    for _ in range(tries):
        if failed == len(RAMP_SHAPES):
            reduction, failed = reduction + 1, 0
            if reduction == len(REDUCTIONS):
                break
        peak = _shaped_ramp(trial, state, target, REDUCTIONS[reduction] * within, RAMP_SHAPES[shape])
        if (
            peak >= 0.0
            and trial[3] + trial[4] + trial[5] < within - MIN_TIME_SAVED
            and min(trial[3], trial[5]) >= 3.0 * dt  # shorter phases would break the jerk limit between setpoints
            and _largest_rate(trial) <= max_rate
            and check_ramp(table, step, trial, sent, limits, dt)[0] == LIMITS_KEPT
        ):
            best, within, failed = peak, trial[3] + trial[4] + trial[5], 0
            ramp[:] = trial
        else:
            shape, failed = (shape + 1) % len(RAMP_SHAPES), failed + 1
    return best


@kernel
def _shaped_ramp(ramp: Array, state: Array, target: float, duration: float, shape: float) -> float:
    """Write a ramp of about a duration [s]; return its peak |r'|, or -1 without one.

    Args:
        shape: share of the change of rate in the first and last phase together: at 1 there is no phase between them.
    """
    direction = 1.0 if target >= state[1] else -1.0
    rise, slope = direction * (target - state[1]), direction * state[2]
    peak, hardest = 0.0, np.inf
    for _ in range(SHAPE_ITERATIONS):  # as if it had begun at r' = 0
        whole, span = rise + slope * slope / (2.0 * hardest), duration + slope / hardest
        if whole <= 0.0 or span <= 0.0:
            return -1.0
        peak = (1.0 + shape) * whole / span
        hardest = peak * peak / (shape * whole)
    return float(shortest_ramp(ramp, state, target, peak, hardest))


@kernel
def _largest_rate(ramp: Array) -> float:
    """Return the largest |r| of a ramp; where r' first has to change its sign, that is before the ramp's end."""
    turning: float = ramp[1]
    if ramp[2] * ramp[6] < 0.0:
        turning -= ramp[2] * ramp[2] / (2.0 * ramp[6])
    return float(max(abs(ramp[1]), abs(turning), abs(ramp[7])))


@kernel
def _search_bounds(table: Array, step: float, state: Array, limits: Array, dt: float) -> tuple[float, float]:
    """Return the largest |r'| and |r''| worth a trial: those that alone would use up the joints' limits."""
    last = table.shape[0] - 1
    row = min(max(int(state[0] / step + 0.5), 0), last)
    reach = int(state[1] * LOOKAHEAD_TIME / step)
    steepest, hardest = MAX_RATE_ACCELERATION, MAX_RATE_JERK
    for i in range(limits.shape[1]):
        moving = 1e-12
        for share in range(3):
            moving = max(moving, abs(table[min(max(row + reach * share // 2, 0), last), 1, i]))
        steepest = min(steepest, 1.15 * limits[1, i] / dt**2 / moving)
        hardest = min(hardest, 1.3 * limits[2, i] / dt**3 / moving)
    return max(steepest, abs(state[2])), hardest
