"""Dynamic programming over a grid of places on a path and angles, and the spline that smooths what it finds."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.ndimage import gaussian_filter1d

from teachpath.records import Array

FILTER_WIDTH: Final = 2.0  # rows of the grid, standard deviation of the filter that smooths the angles
SPLINE_DEGREE: Final = 5  # of the angles as a function of the curve's parameter


def cheapest_sequence(costs: Array, max_change: int) -> NDArray[np.int64] | None:
    """Return the column at each row (k,) of the cheapest sequence through a grid of costs (k, m); None without one.

    Args:
        costs: (k, m), infinite where the sequence must not go.
        max_change: of the column between two rows; a change by c costs c^2.
    """
    count = costs.shape[1]
    total, previous = costs[0], []
    for row in costs[1:]:
        padded = np.pad(total, max_change, constant_values=np.inf)
        trials = np.stack([padded[k : k + count] + (k - max_change) ** 2 for k in range(2 * max_change + 1)])
        previous.append(np.arange(count) + trials.argmin(axis=0) - max_change)
        total = trials.min(axis=0) + row
    if not np.isfinite(total.min()):
        return None
    chosen = [int(np.argmin(total))]
    for back in reversed(previous):
        chosen.append(int(back[chosen[-1]]))
    return np.array(chosen[::-1])


def smoothed(u: Array, angles: Array) -> BSpline[np.float64]:
    """Return a spline near angles (k,) at parameters `u` (k,); with angles for coefficients, it does not overshoot."""
    smooth = gaussian_filter1d(angles, FILTER_WIDTH, mode="nearest")
    inner = np.interp(np.linspace(0, len(u) - 1, max(len(u) // 3, 2)), np.arange(len(u)), u)
    knots = np.concatenate([np.zeros(SPLINE_DEGREE), inner, np.ones(SPLINE_DEGREE)])
    knots[SPLINE_DEGREE], knots[-SPLINE_DEGREE - 1] = 0.0, 1.0
    greville = np.convolve(knots[1:-1], np.full(SPLINE_DEGREE, 1 / SPLINE_DEGREE), mode="valid")
    return BSpline(knots, np.interp(greville, u, smooth), SPLINE_DEGREE)
