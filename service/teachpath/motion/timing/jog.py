"""Steps along a trajectory: from rest to rest between two plan times, within the limits of the trajectory."""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.errors import Conflict
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.timing.joint_moves import rest_to_rest
from teachpath.motion.timing.limit_margins import SYMMETRIC_MARGINS, limit_uses
from teachpath.motion.timing.timed_trajectory import MAX_TABLE_STEP, TimedTrajectory, apply_chain_rule

NODE_TOLERANCE: Final = 1e-5  # [m] within which the arm is at a node
MIN_JOG: Final = 1e-6  # s of plan time; a shorter step is none
MAX_SLOWDOWNS: Final = 4  # of one step
MAX_TIME_ACCELERATION: Final = 1e3  # 1/s, second derivative of plan time, where the joints hardly move
MAX_TIME_JERK: Final = 1e5  # 1/s^2, third derivative of plan time
SETPOINT_PHASES: Final = (0.0, 0.25, 0.5, 0.75)  # of the first setpoint, in control periods


def time_at_length(trajectory: TimedTrajectory, s: float) -> float:
    """Return the plan time [s] at which a trajectory reaches arc length `s` [m]."""
    return float(
        np.interp(
            s, np.maximum.accumulate(trajectory.table[:, 0, -1]), np.arange(len(trajectory.table)) * trajectory.step
        )
    )


def node_length(lengths: Array, at: float, count: int) -> float:
    """Return the length [m] of the node that is `count` nodes away from length `at`; a node there does not count."""
    if count > 0:
        node = int(np.searchsorted(lengths, at + NODE_TOLERANCE, side="right")) + count - 1
    else:
        node = int(np.searchsorted(lengths, at - NODE_TOLERANCE, side="left")) + count
    return float(lengths[min(max(node, 0), len(lengths) - 1)])


def jog_trajectory(trajectory: TimedTrajectory, begin: float, end: float, rate: float) -> TimedTrajectory:
    """Return the trajectory of a step: from rest at plan time `begin` to rest at `end` [s], in either direction.

    The joints follow q(tau(t)), where tau(t) is one call of Ruckig, slowed down until the setpoints keep the limits.
    Like every trajectory, it may be run slower, held and reversed.

    Args:
        trajectory: along which the arm moves.
        begin: plan time of the start [s].
        end: plan time of the end [s].
        rate: setpoints a second on which the limits are checked [Hz].

    Raises:
        Conflict: the trajectory ends here in that direction.
    """
    distance = abs(end - begin)
    if distance < MIN_JOG:
        raise Conflict("the path ends here; there is nothing left to go in that direction")
    low, high = sorted((begin, end))
    rows = trajectory.table[int(low / trajectory.step) : int(np.ceil(high / trajectory.step)) + 1]
    steepest = np.maximum(np.abs(rows[:, 1, :-1]).max(axis=0), 1e-9)  # of the joints by plan time
    acceleration = min(float(np.min(trajectory.limits.acceleration / steepest)), MAX_TIME_ACCELERATION)
    jerk = min(float(np.min(trajectory.limits.jerk / steepest)), MAX_TIME_JERK)
    slower = 1.0
    for _ in range(MAX_SLOWDOWNS):
        tau, one, two, three, step = rest_to_rest(
            distance, 1.0 / slower, acceleration / slower**2, jerk / slower**3, MAX_TABLE_STEP
        )
        ahead = np.sign(end - begin)
        made = TimedTrajectory(
            apply_chain_rule(_along(trajectory, begin + ahead * tau), ahead * one, ahead * two, ahead * three),
            step,
            trajectory.limits,
        )
        factor = _too_fast(made, rate)
        if factor <= 1.0:
            break
        slower *= factor * 1.001
    return made


def _along(trajectory: TimedTrajectory, tau: Array) -> list[Array]:
    """Return joints and arc length (n, joints + 1) at plan times (n,), and their three derivatives by plan time."""
    row = np.clip(np.rint(tau / trajectory.step).astype(np.int64), 0, len(trajectory.table) - 1)
    ahead = (tau - row * trajectory.step)[:, None]
    value, first, second, third = (trajectory.table[row, k] for k in range(4))
    return [
        value + ahead * (first + ahead / 2 * (second + ahead / 3 * third)),
        first + ahead * (second + ahead / 2 * third),
        second + ahead * third,
        third,
    ]


def _too_fast(trajectory: TimedTrajectory, rate: float) -> float:
    speed, acceleration, jerk = SYMMETRIC_MARGINS
    factor = 0.0
    for phase in SETPOINT_PHASES:
        v, a, j = (
            float(use.max()) for use in limit_uses(trajectory.setpoints(rate, phase=phase), trajectory.limits, rate)
        )
        factor = max(factor, v / speed, np.sqrt(a / acceleration), np.cbrt(j / jerk))
    return factor
