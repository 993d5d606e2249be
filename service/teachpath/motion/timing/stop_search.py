"""Searches for the shortest stop along a trajectory whose setpoints keep all limits (compiled; see `kernels`).

The third derivative of plan time is constant in each control period. The stop brakes as hard as the joints allow,
period by period, and from one period on it releases the brake as fast as they allow, so that rate and slope reach zero
together. That period is the latest one from which this can be done. Where braking leads to a place at which no third
derivative keeps the limits of all joints, the periods before it brake less. A stop whose setpoints break a limit all
the same is searched for again with smaller limits around them.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.motion.arm.puma560 import Array
from teachpath.motion.timing.kernels import kernel, place_in_table
from teachpath.motion.timing.ramp_checks import check_states

INITIAL_SHARE: Final = 0.995  # of the joints' limits that the first trial uses
TARGET_USE: Final = 0.99  # of a limit, to which the periods around a setpoint that breaks it are reduced
MAX_REPAIRS: Final = 12  # places in one trial before which the arm is let brake less
RECOVERY_SHARE: Final = 0.9  # of the largest third derivative, with which less braking is prepared
SLOPE_STEP: Final = 0.2  # 1/s^2, of the difference that tells how much less it must be
RELEASE_EXCESS: Final = 3.0  # times the largest third derivative, from which a release is hopeless
ENDING_TOLERANCE: Final = 1.05  # times the largest third derivative, in the last period; the check decides
SPLITS: Final = 2  # halvings of the period in which the brake is released
UNBOUNDED_JERK: Final = 1e7  # 1/s^3


@kernel
def find_stop(
    table: Array, step: float, state: Array, sent: Array, limits: Array, dt: float, max_rate: float,
    tries: int, out: Array,
) -> int:  # fmt: skip
    """Search for the shortest stop within all limits; write its states (n, 3), one a period, and return n, or 0.

    Args:
        state: (3,) tau, r and r' where it begins.
        sent: (PHASES, 3, joints) see `ramp_checks.advance`.
        max_rate: largest |r| that the limit of the tool's speed allows.
        tries: stops that are checked at most.
        out: (m, 3) tau, r and r' at the end of each period; m bounds the stop's duration.
    """
    rows = out.shape[0]
    direction = 1.0 if state[1] > 0.0 or (state[1] == 0.0 and state[2] > 0.0) else -1.0
    joints = limits.shape[1]
    bounds = np.empty((2, joints))
    for i in range(joints):
        bounds[0, i], bounds[1, i] = limits[1, i] / dt**2, limits[2, i] / dt**2
    shares, uses = np.full(rows + 1, INITIAL_SHARE), np.empty(rows)
    states, trial, bends = np.empty((rows + 1, 3)), np.empty((rows + 1, 3)), np.empty((rows + 1, joints))
    jerks, floor = np.empty((rows + 1, 2)), np.empty(rows + 1)
    states[0, 0], states[0, 1], states[0, 2] = state[0], direction * state[1], direction * state[2]
    for _ in range(tries):
        count = _brake(table, step, direction, bounds, dt, shares, states, bends, jerks, floor)
        count = _latest_release(table, step, direction, bounds, dt, shares, count, states, bends, jerks, trial)
        if count == 0:
            return 0
        fastest = 0.0
        for k in range(count):
            fastest = max(fastest, trial[k + 1, 1])
            out[k, 0], out[k, 1], out[k, 2] = trial[k + 1, 0], direction * trial[k + 1, 1], direction * trial[k + 1, 2]
        if fastest > max_rate:
            return 0
        if check_states(table, step, state, out, count, sent, limits, dt, uses):
            return count
        _reduce_around_excess(uses, count, shares)
    return 0


@kernel
def _reduce_around_excess(uses: Array, count: int, shares: Array) -> None:
    """Reduce the shares of the periods on which the third difference of a setpoint that breaks a limit depends."""
    reduced = np.ones(count)
    for k in range(count):
        if uses[k] > 1.0:
            for i in range(max(k - 3, 0), min(k + 2, count)):
                reduced[i] = min(reduced[i], TARGET_USE / uses[k])
    for k in range(count):
        shares[k] *= reduced[k]


@kernel
def _brake(
    table: Array, step: float, direction: float, bounds: Array, dt: float, shares: Array, states: Array, bends: Array,
    jerks: Array, floor: Array,
) -> int:  # fmt: skip
    """Brake as hard as the joints allow; write states, the joints' accelerations and the ranges of third derivatives.

    Args:
        states: (n, 3); the first one is given, in the direction of motion.
        bends: (n, joints) accelerations of the joints in these states [rad/s^2].
        jerks: (n, 2) range of the third derivative in the period behind each state.
        floor: (n,) least slope for the sake of a later state.

    Returns:
        How many states were written.
    """
    last, rows = table.shape[0] - 1, states.shape[0]
    base, gain = np.empty(bounds.shape[1]), np.empty(bounds.shape[1])
    floor[:] = -UNBOUNDED_JERK
    _bend(table, step, direction, states[0], bends[0])
    k = repairs = 0
    while k < rows - 1:
        tau, r, a = states[k, 0], states[k, 1], states[k, 2]
        low, high = _jerk_range(table, step, direction, bounds, dt, shares[k], tau, r, a, bends[k], base, gain)
        jerks[k, 0], jerks[k, 1] = low, high
        jerk = max(low, (floor[k + 1] - a) / dt)
        if jerk > high:
            jerk = 0.5 * (low + high) if low > high else high
            if repairs < MAX_REPAIRS:
                repairs += 1
                slope = floor[k + 1] - dt * high
                if low > high:
                    given = (table, step, direction, bounds, dt, shares[k], tau, r, a, bends[k])
                    slope = max(slope, _less_braking(*given, gain, low - high))
                begin = _raise_floor(floor, states, jerks, k, slope, dt)
                if begin >= 0:
                    k = begin
                    continue
            if low > high:
                return k + 1
        if a < 0.0 and a * a > 2.0 * r * RELEASE_EXCESS * max(high, 0.0):
            return k + 1
        tau, r, a = _advanced(direction, dt, tau, r, a, jerk)
        if r <= 0.0 or not 0.0 < tau < last * step:
            return k + 1
        k += 1
        states[k, 0], states[k, 1], states[k, 2] = tau, r, a
        for i in range(len(base)):
            bends[k, i] = base[i] + gain[i] * jerk
    return k + 1


@kernel
def _less_braking(
    table: Array, step: float, direction: float, bounds: Array, dt: float, share: float, tau: float, r: float, a: float,
    bend: Array, gain: Array, gap: float,
) -> float:  # fmt: skip
    """Return the slope in a state that closes the gap by which the range of third derivatives is empty (Newton)."""
    less = bend + SLOPE_STEP / dt * gain
    given = (table, step, direction, bounds, dt, share, tau, r, a + SLOPE_STEP)
    low, high = _jerk_range(*given, less, np.empty_like(less), np.empty_like(less))
    closing = (gap - (low - high)) / SLOPE_STEP
    return a + (1.1 * gap / closing + 0.01 if closing > 1e-3 else 0.05 * abs(a))


@kernel
def _raise_floor(floor: Array, states: Array, jerks: Array, k: int, slope: float, dt: float) -> int:
    """Raise the floor so that state `k` can have at least this slope; return where to begin anew, or -1."""
    while k > 0 and slope > states[k, 2]:
        floor[k] = max(floor[k], slope)
        slope = floor[k] - dt * RECOVERY_SHARE * max(jerks[k - 1, 1], 0.0)
        k -= 1
    return k if k > 0 or slope <= states[0, 2] else -1


@kernel
def _latest_release(
    table: Array, step: float, direction: float, bounds: Array, dt: float, shares: Array, count: int, states: Array,
    bends: Array, jerks: Array, out: Array,
) -> int:  # fmt: skip
    """Find the latest state from which the brake can be released, write the stop, and return its periods, or 0.

    Args:
        count: of `states`, `bends` and `jerks` (see `_brake`).
        out: (m, 3) where the states are written, from row 1 on.
    """
    first = 0
    while first < count and states[first, 2] >= 0.0:
        first += 1
    at = first
    while at < count - 1 and states[at, 2] ** 2 < 2.0 * states[at, 1] * jerks[at, 1]:
        at += 1
    good, bad, found, reach = first - 1, count, 0, 1
    trial = np.empty(out.shape)
    while bad - good > 1:
        rests = _release(table, step, direction, bounds, dt, shares, at, 0.0, states, bends, trial)
        if rests > 0:
            good, found = at, rests
            out[at + 1 : found + 1] = trial[at + 1 : found + 1]
            at += reach
        else:
            bad = at
            at -= reach
        reach *= 2
        if not good < at < bad:
            at = (good + bad) // 2
    if found == 0:
        return 0
    out[1 : good + 1] = states[1 : good + 1]
    least, most = 0.0, 1.0
    for _ in range(SPLITS):
        share = 0.5 * (least + most)
        sooner = _release(table, step, direction, bounds, dt, shares, good, share, states, bends, trial)
        if sooner == 0:
            most = share
            continue
        least = share
        if sooner <= found:
            found = sooner
            out[good + 1 : found + 1] = trial[good + 1 : found + 1]
    return found


@kernel
def _release(
    table: Array, step: float, direction: float, bounds: Array, dt: float, shares: Array, k: int, braking: float,
    states: Array, bends: Array, out: Array,
) -> int:  # fmt: skip
    """Release the brake from state `k` on; write the states behind it up to rest, and return the last one's row, or 0.

    Args:
        braking: share of the first period in which it still brakes.
    """
    end = (table.shape[0] - 1) * step
    tau, r, a = states[k, 0], states[k, 1], states[k, 2]
    bend, base, gain = bends[k].copy(), np.empty_like(bends[k]), np.empty_like(bends[k])
    while k < out.shape[0] - 2 and a < 0.0:
        low, high = _jerk_range(table, step, direction, bounds, dt, shares[k], tau, r, a, bend, base, gain)
        left, needed = -2.0 * r / a, a * a / (2.0 * r)  # a constant third derivative leads to rest
        if left <= 1.5 * dt:
            if needed > ENDING_TOLERANCE * high:
                return 0
            if left > dt:
                k += 1
                out[k] = _advanced(direction, dt, tau, r, a, needed)
            tau, _, _ = _advanced(direction, left, tau, r, a, needed)
            out[k + 1, 0], out[k + 1, 1], out[k + 1, 2] = tau, 0.0, 0.0
            return k + 1
        jerk = min(high, needed)
        jerk = braking * min(low, jerk) + (1.0 - braking) * jerk if braking > 0.0 else max(jerk, low)
        braking = 0.0
        tau, r, a = _advanced(direction, dt, tau, r, a, jerk)
        if r <= 0.0 or not 0.0 < tau < end:
            return 0
        k += 1
        out[k, 0], out[k, 1], out[k, 2] = tau, r, a
        for i in range(len(bend)):
            bend[i] = base[i] + gain[i] * jerk
    return 0


@kernel
def _advanced(direction: float, t: float, tau: float, r: float, a: float, jerk: float) -> tuple[float, float, float]:
    """Return tau, rate and slope after `t` [s]; the rate and its derivatives are in the direction of motion."""
    return tau + direction * t * (r + t * (a / 2.0 + t * jerk / 6.0)), r + t * (a + t * jerk / 2.0), a + t * jerk


@kernel
def _bend(table: Array, step: float, direction: float, state: Array, out: Array) -> None:
    """Write the joints' accelerations (joints,) [rad/s^2] in a state."""
    row, ahead = place_in_table(table, step, state[0])
    for i in range(len(out)):
        second = table[row, 2, i] + ahead * table[row, 3, i]
        first = table[row, 1, i] + ahead * (table[row, 2, i] + ahead / 2.0 * table[row, 3, i])
        out[i] = direction * first * state[2] + second * state[1] ** 2


@kernel
def _jerk_range(
    table: Array, step: float, direction: float, bounds: Array, dt: float, share: float, tau: float, r: float,
    a: float, bend: Array, base: Array, gain: Array,
) -> tuple[float, float]:  # fmt: skip
    """Return the third derivatives with which the joints keep their limits of acceleration and jerk for one period.

    A joint's acceleration at the end of the period is nearly linear in the third derivative: base + gain x; its jerk is
    what it changes by. The range is empty, lowest above highest, where no third derivative does for all joints.

    Args:
        bounds: (2, joints) of the joints' accelerations and of their change in a period [rad/s^2]
        share: of them that may be used.
        bend: (joints,) the joints' accelerations now [rad/s^2].
        base: (joints,) where the bases are written.
        gain: (joints,) where the gains are written.
    """
    rate = r + a * dt
    row, ahead = place_in_table(table, step, tau + direction * dt * (r + dt * a / 2.0))
    lowest, highest = -UNBOUNDED_JERK, UNBOUNDED_JERK
    for i in range(len(bend)):
        two = table[row, 2, i] + ahead * table[row, 3, i]
        one = direction * (table[row, 1, i] + ahead * (table[row, 2, i] + ahead / 2.0 * table[row, 3, i]))
        b, g = one * a + two * rate * rate, dt * (one + two * rate * dt)
        base[i], gain[i] = b, g
        most, change = share * bounds[0, i], share * bounds[1, i]
        low, high = max(-most, bend[i] - change), min(most, bend[i] + change)
        inverse = 1.0 / g if abs(g) > 1e-9 else UNBOUNDED_JERK
        x, y = (low - b) * inverse, (high - b) * inverse
        lowest, highest = max(lowest, min(x, y)), min(highest, max(x, y))
    return lowest, highest
