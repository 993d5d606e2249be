"""The best jerk-limited duration found by brute force: what the plan's local optimum is held against.

Dynamic programming over (sigma, x, x') where x = (d sigma / dt)^2, with x'' constant on even pieces and so quantised
that every step ends on the grid: nothing is interpolated, and every basin is searched. Limits are imposed at both ends
of each piece. The plan's parameter sigma is used, but neither its spline nor its solver. The grid's coarseness costs a
few percent, so a plan that is no slower than this has missed no better basin.
"""

import numba
import numpy as np

from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.limits import MotionLimits

PIECES = 120
LEVELS = 1000  # of x
LOWEST_RATE, HIGHEST_RATE = 0.4, 1.75  # range of x, times the duration squared
STEEPEST_SLOPE = 22.0  # largest |x'|, likewise


def best_duration(path: JointPath, limits: MotionLimits, duration: float) -> float:
    """Return the shortest duration [s] on the grid.

    Args:
        path: whose parameter is nearly proportional to time.
        limits: of the joints, kept without reserve.
        duration: of a plan, for the scale of the grid.
    """
    step = 1.0 / PIECES
    grain = (HIGHEST_RATE - LOWEST_RATE) / LEVELS  # x changes by half a quantum of x'' over a step
    quantum = 2.0 * grain / step**2
    half = int(STEEPEST_SLOPE / (quantum * step))
    nodes = np.linspace(0.0, 1.0, PIECES + 1)
    one, two, three = (path(nodes, k)[:, :6] / duration**k for k in (1, 2, 3))
    v, a, j = limits.speed, limits.acceleration, limits.jerk
    ceiling = np.min((v / np.maximum(np.abs(one), 1e-12)) ** 2, axis=1)
    return duration * _search(ceiling, two / a, one / a, three / j, two / j, one / j, step, grain, quantum, half)


@numba.njit(fastmath=True)
def _search(ceiling, a2, a1, j3, j2, j1, step, grain, quantum, half):  # type: ignore[no-untyped-def]
    slopes = 2 * half + 1
    after = np.zeros((LEVELS + 1, slopes))
    for k in range(len(ceiling) - 2, -1, -1):
        before = np.full((LEVELS + 1, slopes), np.inf)
        for level in range(LEVELS + 1):
            x = LOWEST_RATE + level * grain
            if x > ceiling[k]:
                continue
            for index in range(slopes):
                slope = (index - half) * quantum * step
                low, high = _range(x, slope, a2[k], a1[k], j3[k], j2[k], j1[k])
                if low > high:
                    continue
                first = max(int(np.ceil(low / quantum)), -index)
                last = min(int(np.floor(high / quantum)), slopes - 1 - index)
                for push in range(first, last + 1):
                    there = level + 2 * (index - half) + push
                    if there < 0 or there > LEVELS or after[there, index + push] == np.inf:
                        continue
                    y, bend = LOWEST_RATE + there * grain, push * quantum
                    if _kept(y, slope + bend * step, bend, j3[k + 1], j2[k + 1], j1[k + 1]):
                        middle = x + slope * step / 2 + bend * step**2 / 8
                        lasting = step * (1 / np.sqrt(x) + 4 / np.sqrt(middle) + 1 / np.sqrt(y)) / 6
                        before[level, index] = min(before[level, index], after[there, index + push] + lasting)
        after = before
    return after.min()


@numba.njit(fastmath=True)
def _range(x, slope, a2, a1, j3, j2, j1):  # type: ignore[no-untyped-def]
    """Return the range of x'' that the limits allow at a place; an empty one when a limit of acceleration is broken."""
    low, high = -1e18, 1e18
    for i in range(6):
        if abs(a2[i] * x + 0.5 * a1[i] * slope) > 1.0:
            return 1.0, 0.0
        base, gain = j3[i] * x + 1.5 * j2[i] * slope, 0.5 * j1[i]
        if abs(gain) >= 1e-9:
            one, other = (-1.0 / np.sqrt(x) - base) / gain, (1.0 / np.sqrt(x) - base) / gain
            low, high = max(low, min(one, other)), min(high, max(one, other))
        elif abs(base) * np.sqrt(x) > 1.0:
            return 1.0, 0.0
    return low, high


@numba.njit(fastmath=True)
def _kept(x, slope, bend, j3, j2, j1):  # type: ignore[no-untyped-def]
    """Tell whether the jerk limits are kept at a place."""
    most = 0.0
    for i in range(6):
        most = max(most, abs(j3[i] * x + 1.5 * j2[i] * slope + 0.5 * j1[i] * bend))
    return most * np.sqrt(x) <= 1.0
