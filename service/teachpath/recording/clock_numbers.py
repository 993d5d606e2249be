"""Numbers for readings that have none: by their clock, so that what is missing between them shows as lost."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from teachpath.records import Array

Integers = NDArray[np.int64]

IRREGULARITY_THRESHOLD = 0.25  # of a period, by which a tenth of the steps miss a whole number of periods
GAP_THRESHOLD = 1.5  # periods; a longer step passes over readings


def number_by_clock(stamps_ns: Integers, positions: Array) -> Integers:
    """Return the number of each reading, from 1.

    Readings are numbered in the order of their stamps. A step of several periods of a regular clock passes over
    numbers; a clock that is not regular tells nothing of losses. A reading with stamp and position of the one before is
    the same one and has the same number.

    Args:
        stamps_ns: (n,) in any order, n > 0.
        positions: (n, 3).
    """
    order = np.argsort(stamps_ns, kind="stable")
    steps = np.diff(stamps_ns[order])
    same = (steps == 0) & np.all(np.diff(positions[order], axis=0) == 0.0, axis=1)
    passed = np.where(same, 0, np.ones(len(steps), dtype=np.int64))
    period = clock_period(steps)
    if period:
        periods = np.round(steps / period).astype(np.int64)
        passed = np.where(steps > GAP_THRESHOLD * period, np.maximum(periods, 1), passed)
    numbers = np.empty(len(stamps_ns), dtype=np.int64)
    numbers[order] = 1 + np.concatenate([[0], np.cumsum(passed)])
    return numbers


def clock_period(steps: Integers) -> float:
    """Return the period [ns] of a regular clock, 0 of another one.

    Args:
        steps: (n,) [ns] from each stamp to the next, not negative.
    """
    rising = steps[steps > 0]
    if not len(rising):
        return 0.0
    period = float(np.median(rising))
    misses = np.abs(rising / period - np.round(rising / period))
    return period if np.quantile(misses, 0.9) < IRREGULARITY_THRESHOLD else 0.0


def without_stride(numbers: Integers) -> Integers:
    """Return the numbers of readings of which the file keeps every second, third, ... one as consecutive ones.

    Args:
        numbers: (n,) as the file has them.
    """
    steps = np.diff(np.unique(numbers))
    stride = int(np.gcd.reduce(steps)) if len(steps) else 1
    return (numbers - numbers.min()) // max(stride, 1) + 1 if stride > 1 else numbers
