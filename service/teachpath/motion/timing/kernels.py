"""Compiled arithmetic of the control loop: evaluates tables of a trajectory, and ramps of the rate.

Plan time tau runs at the rate r = d tau / dt; a *ramp* takes r to a new constant value in three phases of constant
third derivative of tau (up, constant, down). A ramp is an array of eight: tau, r and r' at its beginning, the
durations of its phases, the third derivative in the first phase, and r at its end.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

from teachpath.compiled import F, compiled
from teachpath.motion.arm.puma560 import Array

kernel: Callable[[F], F] = compiled(error_model="numpy")  # which lets a division by zero give what it gives in numpy


@kernel
def place_in_table(table: Array, step: float, tau: float) -> tuple[int, float]:
    """Return the row nearest to plan time `tau`, and how far ahead of it that is [s]; outside the plan, of its ends."""
    last = table.shape[0] - 1
    tau = min(tau, last * step) if tau > 0.0 else 0.0  # what is no number must not become a row
    row = min(int(tau / step + 0.5), last)
    return row, tau - row * step


@kernel
def evaluate_table(table: Array, step: float, tau: float, out: Array) -> None:
    """Write joints and arc length (joints + 1,) at plan time `tau` to `out`; outside the plan, those of its ends."""
    row, ahead = place_in_table(table, step, tau)
    for i in range(len(out)):
        out[i] = table[row, 0, i] + ahead * (
            table[row, 1, i] + ahead / 2.0 * (table[row, 2, i] + ahead / 3.0 * table[row, 3, i])
        )


@kernel
def evaluate_ramp(ramp: Array, t: float) -> tuple[float, float, float]:
    """Return tau, r and r' at time `t` after the beginning of a ramp."""
    tau, r, a, jerk = ramp[0], ramp[1], ramp[2], ramp[6]
    for phase in range(3):
        j = jerk if phase == 0 else (0.0 if phase == 1 else -jerk)
        d = min(t, ramp[3 + phase])
        tau += d * (r + d * (a / 2.0 + d * j / 6.0))
        r += d * (a + d * j / 2.0)
        a += d * j
        t -= d
        if t <= 0.0:
            return tau, r, a
    return tau + t * ramp[7], ramp[7], 0.0


@kernel
def shortest_ramp(ramp: Array, state: Array, target: float, steepest: float, hardest: float) -> float:
    """Write the shortest ramp from a state (tau, r, r') to a constant rate; return its peak |r'|, or -1 without one.

    The velocity problem of L. Berscheid & T. Kröger, Jerk-limited real-time trajectory generation with arbitrary target
    states (Robotics: Science and Systems 2021), in one dimension and to zero acceleration.
    """
    r, a = state[1], state[2]
    d = 1.0 if target - r - a * abs(a) / (2.0 * hardest) >= 0.0 else -1.0
    rise, b = d * (target - r), d * a
    peak = sqrt(max(hardest * rise + b * b / 2.0, 0.0))
    flat = 0.0
    if peak > steepest:
        peak = steepest
        flat = (rise - (2.0 * peak * peak - b * b) / (2.0 * hardest)) / peak
    if peak < b or flat < 0.0:
        return -1.0
    if target == 0.0 and r * d > 0.0:  # it would stop only after a change of direction
        return -1.0
    ramp[0], ramp[1], ramp[2] = state[0], r, a
    ramp[3], ramp[4], ramp[5] = (peak - b) / hardest, flat, peak / hardest
    ramp[6], ramp[7] = d * hardest, target
    return peak


@kernel
def evaluate_motion(table: Array, step: float, state: Array, out: Array) -> None:
    """Write value, velocity and acceleration (3, joints + 1) of joints and arc length at (tau, r, r') to `out`."""
    evaluate_table(table, step, state[0], out[0])
    row, ahead = place_in_table(table, step, state[0])
    for i in range(out.shape[1]):
        first = table[row, 1, i] + ahead * (table[row, 2, i] + ahead / 2.0 * table[row, 3, i])
        second = table[row, 2, i] + ahead * table[row, 3, i]
        out[1, i] = first * state[1]
        out[2, i] = second * state[1] ** 2 + first * state[2]
