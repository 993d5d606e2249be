"""The fastest velocity profile under speed and acceleration limits alone: a guess for timing, and its lower bound.

With x = p'^2 and u = p'' every limit is linear in (x, u); one pass backward and one forward over a grid find the
largest x (Pham & Pham, A new approach to time-optimal path parameterization based on reachability analysis, IEEE
Transactions on Robotics 34(3), 2018).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from teachpath.motion.arm.puma560 import Array

EPSILON: Final = 1e-12

Mask = NDArray[np.bool_]


def max_squared_rates(grid: Array, first: Array, second: Array, speed: Array, acceleration: Array, cap: Array) -> Array:
    """Find the largest x = p'^2 at every point of a grid of p, from rest to rest.

    Args:
        grid: (n,) increasing.
        first: (n, joints) dq/dp at the points.
        second: (n, joints) d2q/dp2.
        speed: (joints,) limits [rad/s].
        acceleration: (joints,) limits [rad/s^2].
        cap: (n,) or scalar, upper bound of x for other reasons.

    Returns:
        (n,) [1/s^2].
    """
    steps = 2.0 * np.diff(grid)
    a, b = np.concatenate([first, -first], axis=1), np.concatenate([second, -second], axis=1)  # a u + b x <= c
    with np.errstate(divide="ignore", invalid="ignore"):
        top, slope = np.concatenate([acceleration, acceleration]) / a, b / a  # u <= top - slope x where a > 0
        highest = np.minimum(np.min(np.where(np.abs(first) > EPSILON, (speed / first) ** 2, np.inf), axis=1), cap)
    up, down = a > EPSILON, a < -EPSILON
    highest = np.minimum(highest, _without_next(top, slope, up, down, np.append(steps, steps[-1])))
    still = np.where((np.abs(first) <= EPSILON) & (np.abs(second) > EPSILON), acceleration, np.inf)
    highest = np.minimum(highest, np.min(still / np.maximum(np.abs(second), EPSILON), axis=1))
    reachable = np.zeros(len(grid))
    for k in range(len(grid) - 2, 0, -1):
        steeper = 1.0 / steps[k] - slope[k][down[k]]
        room = reachable[k + 1] / steps[k] - top[k][down[k]]
        reachable[k] = max(np.min(room[steeper > 0] / steeper[steeper > 0], initial=highest[k]), 0.0)
    found = np.zeros(len(grid))
    for k in range(len(grid) - 1):
        push = np.min(top[k][up[k]] - slope[k][up[k]] * found[k], initial=np.inf)
        found[k + 1] = min(reachable[k + 1], max(found[k] + steps[k] * push, 0.0))
    return found


def reach_times(grid: Array, squares: Array) -> Array:
    """Return the times (n,) [s] at which the points of the grid are reached, for piecewise linear x (n,)."""
    rates = np.sqrt(squares)
    slowest = 1e-3 * rates.max()
    return np.concatenate([[0.0], np.cumsum(2.0 * np.diff(grid) / np.maximum(rates[1:] + rates[:-1], slowest))])


def _without_next(top: Array, slope: Array, up: Mask, down: Mask, steps: Array) -> Array:
    """Return bounds (n,) of x at each point that do not depend on the next point."""
    with np.errstate(divide="ignore", invalid="ignore"):
        steeper = slope[:, :, None] - slope[:, None, :]
        room = (top[:, :, None] - top[:, None, :]) / steeper
        met = up[:, :, None] & down[:, None, :] & (steeper > EPSILON)
        pairs = np.min(np.where(met, room, np.inf), axis=(1, 2))
        steeper = slope - 1.0 / steps[:, None]  # the next x must not be negative: u >= -x / (2 step)
        nonnegative = np.min(np.where(up & (steeper > EPSILON), top / steeper, np.inf), axis=1)
    return np.asarray(np.minimum(pairs, nonnegative), dtype=np.float64)
