"""The fastest profile along a path under speed and acceleration limits alone: a guess for timing, and its lower bound.

With x = p'^2 and u = p'' every limit is linear in (x, u); one pass backward and one forward over a grid find the largest x
(Pham & Pham, A new approach to time-optimal path parameterization based on reachability analysis, IEEE T-RO 34(3), 2018).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from teachpath.motion.puma560 import Array

TINY: Final = 1e-12


def squared_rates(first: Array, second: Array, speed: Array, acceleration: Array, step: float) -> Array:
    """Find the largest x = p'^2 at every point of an even grid, from rest to rest.

    Args:
        first: (n, 6) dq/dp at the points.
        second: (n, 6) d2q/dp2.
        speed: (6,) limits [rad/s].
        acceleration: (6,) limits [rad/s^2].
        step: of the grid in p.

    Returns:
        (n,) [1/s^2].
    """
    a, b = np.concatenate([first, -first], axis=1), np.concatenate([second, -second], axis=1)  # a u + b x <= c
    c = np.concatenate([acceleration, acceleration])
    with np.errstate(divide="ignore", invalid="ignore"):
        top, slope = c / a, b / a  # u <= top - slope x where a > 0, u >= where a < 0
    up, down = a > TINY, a < -TINY
    highest = _without_next(first, second, (top, slope, up, down), speed, acceleration, step)
    reachable = np.zeros(len(a))
    for k in range(len(a) - 2, 0, -1):
        steeper = 1.0 / (2.0 * step) - slope[k][down[k]]
        room = reachable[k + 1] / (2.0 * step) - top[k][down[k]]
        bound = np.min(room[steeper > 0] / steeper[steeper > 0], initial=highest[k])
        reachable[k] = max(bound, 0.0)
    found = np.zeros(len(a))
    for k in range(len(a) - 1):
        push = np.min(top[k][up[k]] - slope[k][up[k]] * found[k], initial=np.inf)
        found[k + 1] = min(reachable[k + 1], max(found[k] + 2.0 * step * push, 0.0))
    return found


def _without_next(
    first: Array,
    second: Array,
    rows: tuple[Array, Array, Array, Array],
    speed: Array,
    acceleration: Array,
    step: float,
) -> Array:
    """Bound x at each point by all that does not depend on the next one: (n,)."""
    top, slope, up, down = rows
    with np.errstate(divide="ignore", invalid="ignore"):
        highest = np.min(np.where(np.abs(first) > TINY, (speed / first) ** 2, np.inf), axis=1)
        still = (np.abs(first) <= TINY) & (np.abs(second) > TINY)
        highest = np.minimum(highest, np.min(np.where(still, acceleration / np.abs(second), np.inf), axis=1))
        pairs = up[:, :, None] & down[:, None, :]
        steeper = slope[:, :, None] - slope[:, None, :]
        room = (top[:, :, None] - top[:, None, :]) / steeper
        highest = np.minimum(highest, np.min(np.where(pairs & (steeper > TINY), room, np.inf), axis=(1, 2)))
        # The next x must not be negative: u >= -x / 2 step.
        steeper = slope - 1.0 / (2.0 * step)
        room = top / steeper
        highest = np.minimum(highest, np.min(np.where(up & (steeper > TINY), room, np.inf), axis=1))
    return np.asarray(highest, dtype=np.float64)


def times(squares: Array, step: float) -> Array:
    """Return when each point of the grid is reached (n,) [s], for x piecewise linear."""
    rates = np.sqrt(squares)
    return np.concatenate([[0.0], np.cumsum(2.0 * step / np.maximum(rates[1:] + rates[:-1], 1e-9))])


def lower_bound(
    q: Callable[[Array, int], Array], speed: Array, acceleration: Array, *, points: int = 2000
) -> float:
    """Return the shortest time [s] on a path q(p), p from 0 to 1, that speed and acceleration limits allow."""
    grid = np.linspace(0.0, 1.0, points + 1)
    squares = squared_rates(q(grid, 1), q(grid, 2), speed, acceleration, 1.0 / points)
    return float(times(squares, 1.0 / points)[-1])
