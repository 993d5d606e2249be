"""A step on the path: from rest to rest between two places of a track, within the same limits as the track itself."""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.errors import Conflict
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.timing.joint_moves import rest_to_rest
from teachpath.motion.timing.limit_margins import RESERVE, uses
from teachpath.motion.timing.timed_trajectory import STEP, Track, composed

LEAST: Final = 1e-6  # s of plan time or m of path, a step shorter than this is none
ROUNDS: Final = 4  # times that a step is slowed down at most
STEEPEST: Final = 1e3  # 1/s, second derivative of plan time where the joints hardly move
HARDEST: Final = 1e5  # 1/s^2, third one
PHASES: Final = (0.0, 0.25, 0.5, 0.75)  # of the first setpoint, in control periods


def place_of(track: Track, s: float) -> float:
    """Return the plan time [s] at which a track is at length `s` [m]."""
    return float(np.interp(s, np.maximum.accumulate(track.table[:, 0, 6]), np.arange(len(track.table)) * track.step))


def stepped(track: Track, begin: float, end: float, rate: float) -> Track:
    """Make the track of a step: the same way, from rest at plan time `begin` to rest at `end` [s], either direction.

    The joints do q(tau(t)); tau(t) is one call of Ruckig, slowed down until the setpoints keep the limits. Like every
    track it may be run slower, held and reversed.

    Args:
        rate: setpoints a second on which limits are checked [Hz].

    Raises:
        Conflict: there is nothing left to go in that direction.
    """
    distance = abs(end - begin)
    if distance < LEAST:
        raise Conflict("the path ends here; there is nothing left to go in that direction")
    low, high = sorted((begin, end))
    rows = track.table[int(low / track.step) : int(np.ceil(high / track.step)) + 1]
    steepest = np.maximum(np.abs(rows[:, 1, :6]).max(axis=0), 1e-9)  # of the joints by plan time
    acceleration = min(float(np.min(track.limits.acceleration / steepest)), STEEPEST)
    jerk = min(float(np.min(track.limits.jerk / steepest)), HARDEST)
    slower = 1.0
    for _ in range(ROUNDS):
        tau, one, two, three, step = rest_to_rest(
            distance, 1.0 / slower, acceleration / slower**2, jerk / slower**3, STEP
        )
        ahead = np.sign(end - begin)
        made = Track(
            composed(_along(track, begin + ahead * tau), ahead * one, ahead * two, ahead * three), step, track.limits
        )
        factor = _too_fast(made, rate)
        if factor <= 1.0:
            break
        slower *= factor * 1.001
    return made


def _along(track: Track, tau: Array) -> list[Array]:
    """Return joints and length (n, 7) at plan times and their three derivatives by plan time."""
    row = np.clip(np.rint(tau / track.step).astype(np.int64), 0, len(track.table) - 1)
    ahead = (tau - row * track.step)[:, None]
    value, first, second, third = (track.table[row, k] for k in range(4))
    return [
        value + ahead * (first + ahead / 2 * (second + ahead / 3 * third)),
        first + ahead * (second + ahead / 2 * third),
        second + ahead * third,
        third,
    ]


def _too_fast(track: Track, rate: float) -> float:
    speed, acceleration, jerk = RESERVE
    factor = 0.0
    for phase in PHASES:
        v, a, j = (float(use.max()) for use in uses(track.setpoints(rate, phase=phase), track.limits, rate))
        factor = max(factor, v / speed, np.sqrt(a / acceleration), np.cbrt(j / jerk))
    return factor
