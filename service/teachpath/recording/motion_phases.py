"""Where a hand without a glove took an object and put it down, found in its motion alone.

A hand dwells where it takes and where it puts. Both dwells are minima of its speed, deeper than all others; what counts
is the depth of a minimum against the peaks around it, so that neither units nor the rate of the clock matter.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import scipy
from numpy.typing import NDArray

from teachpath.records import Array

Indices = NDArray[np.intp]

BORDER_SHARE = 0.08  # share of the readings at either end in which a leap cuts off what lies outside
LEAP_RATIO = 2.5  # times the local median of the steps, over which a step at a border is a leap
LEAP_WINDOW = 9  # steps of that median
SPIKE_WINDOW = 5  # readings of the median that takes out spikes
SMOOTHING_SHARE = 0.015  # standard deviation of the Gaussian, as a share of the duration
MAX_GRID = 2000  # times at which the speed is computed; far finer than the smoothing
MOVING_SPEED_SHARE = (
    0.3  # share of the highest speed; before it is first passed and after it is last passed the hand rests
)
DWELL_SPEED_SHARE = 0.25  # share of the transport's peak speed under which the hand dwells
ONE_DWELL = 0.06  # share of the highest speed; minima between which the hand is never faster are one dwell
SURE_DWELL = np.log(2.5)  # least prominence of both dwells
NO_DWELL = np.log(2.0)  # prominence from which a further minimum may be a dwell too; also least lead over that one
LEAST_SPEED = 1e-3  # share of the highest speed; slower is as slow
MIN_READINGS = 12  # that differ; fewer show no phases


class PhaseEvidence(StrEnum):
    """How the phases of a motion are known."""

    DWELLS = "dwells"  # the hand dwells at two places, and nowhere else
    WHOLE = "whole"  # it dwells nowhere on the way: the motion is the transport alone
    UNSURE = "unsure"  # it dwells at one place, or at more than two


@dataclass(frozen=True, eq=False)
class MotionPhases:
    """The phases of a motion, as far as its speed shows them.

    Attributes:
        evidence: how they are known.
        grasp: index of the reading at which the object was taken; 0 unless the evidence is `dwells`.
        release: index after the last reading of the transport; the number of readings unless the evidence is `dwells`.
        places: (2, 3) [m] where it was taken and put; empty (0, 3) unless there are two dwells.
        dwell_times: (d,) [s] of all minima of the speed that may be dwells.
    """

    evidence: PhaseEvidence
    grasp: int
    release: int
    places: Array
    dwell_times: tuple[float, ...] = ()


def find_motion_phases(times: Array, positions: Array) -> MotionPhases:
    """Find where the hand took and put an object.

    Minima of the smoothed speed are ranked by prominence: the logarithm of the lower of the two peaks that separate a
    minimum from a lower one, over its speed. The two most prominent are taking and putting, in order of time. Each
    place is the mean over its dwell, weighted by the inverse of the speed. It lies 1.4 cm from the labelled place in
    the median of 57 recordings of a hand (hand-polhemus, RIMLab 2015): `python -m tests.experiments.motion_phases`.

    Args:
        times: (n,) [s], rising.
        positions: (n, 3) [m], any frame; finite.

    Returns:
        Also for an unsure motion with two dwells or more the places of the two most prominent ones.
    """
    whole = MotionPhases(PhaseEvidence.WHOLE, 0, len(times), np.empty((0, 3)))
    kept = _without_borders(positions, _distinct(positions))
    if len(kept) < MIN_READINGS:
        return whole
    grid, even, speed = _smoothed(times[kept], positions[kept])
    minima, prominences = _ranked_minima(speed)
    dwells = minima[(prominences > NO_DWELL) & (speed[minima] < MOVING_SPEED_SHARE * speed.max())]
    if not len(dwells):  # a hand that goes around a bend slows down as well, but less
        return whole
    found = tuple(sorted(grid[dwells].tolist()))
    if len(minima) < 2:
        return MotionPhases(PhaseEvidence.UNSURE, 0, len(times), np.empty((0, 3)), found)
    first, last = sorted(minima[:2])
    spans = [_dwell(speed, k, speed[first:last].max()) for k in (first, last)]
    places = np.array([np.average(even[s], axis=0, weights=1.0 / speed[s]) for s in spans])
    third = prominences[2] if len(prominences) > 2 else 0.0
    if prominences[1] <= SURE_DWELL or third >= NO_DWELL or prominences[1] - third <= NO_DWELL:
        return MotionPhases(PhaseEvidence.UNSURE, 0, len(times), places, found)
    grasp, release = (
        _nearest(times, positions, kept, place, grid[s][[0, -1]]) for place, s in zip(places, spans, strict=True)
    )
    return MotionPhases(PhaseEvidence.DWELLS, grasp, release + 1, places, found)


def _distinct(positions: Array) -> Indices:
    """Return the indices of the readings that do not repeat the one before exactly."""
    return np.flatnonzero(np.concatenate([[True], np.any(np.diff(positions, axis=0) != 0.0, axis=1)]))


def _without_borders(positions: Array, kept: Indices) -> Indices:
    """Leave out what lies outside a leap near either end, where a hand comes into view or leaves it."""
    count = len(kept)
    if count < MIN_READINGS:
        return kept
    steps = np.linalg.norm(np.diff(positions[kept], axis=0), axis=1)
    leaps = np.flatnonzero(steps > LEAP_RATIO * scipy.ndimage.median_filter(steps, size=LEAP_WINDOW, mode="nearest"))
    begin = max((k + 1 for k in leaps if k + 1 <= BORDER_SHARE * count), default=0)
    end = min((k + 1 for k in leaps if k >= (1.0 - BORDER_SHARE) * count - 1), default=count)
    return kept[begin:end]


def _smoothed(times: Array, positions: Array) -> tuple[Array, Array, Array]:
    """Return an even grid of times (m,) [s], the positions (m, 3) there and the smoothed speed (m,)."""
    grid = np.linspace(times[0], times[-1], min(len(times), MAX_GRID))
    calm = scipy.ndimage.median_filter(positions, size=(SPIKE_WINDOW, 1), mode="nearest")
    even = np.column_stack([np.interp(grid, times, axis) for axis in calm.T])
    width = SMOOTHING_SHARE * (len(grid) - 1)
    speed = np.linalg.norm(scipy.ndimage.gaussian_filter1d(even, width, axis=0, order=1, mode="nearest"), axis=1)
    return grid, even, np.maximum(speed, max(LEAST_SPEED * float(speed.max()), np.finfo(float).tiny))


def _ranked_minima(speed: Array) -> tuple[Indices, Array]:
    """Return the indices of the minima on the way, one a dwell, and their prominences, the most prominent first."""
    from scipy.signal import find_peaks  # here, because it loads scipy.stats, and each station would start later

    moving = np.flatnonzero(speed > MOVING_SPEED_SHARE * speed.max())
    minima, properties = find_peaks(-np.log(speed), prominence=0.0)
    on_the_way = (minima > moving[0]) & (minima < moving[-1])
    minima, prominences = minima[on_the_way], properties["prominences"][on_the_way]
    separate: list[int] = []
    for k in np.argsort(-prominences, kind="stable").tolist():
        if not any(_is_one_dwell(speed, minima[k], minima[chosen]) for chosen in separate):
            separate.append(k)
    return minima[separate], prominences[separate]


def _is_one_dwell(speed: Array, one: int, other: int) -> bool:
    """Tell whether the hand stays slow between two minima."""
    return bool(speed[min(one, other) : max(one, other) + 1].max() < ONE_DWELL * speed.max())


def _dwell(speed: Array, minimum: int, peak: float) -> slice:
    """Return the span around a minimum in which the hand dwells."""
    fast = np.flatnonzero(speed >= DWELL_SPEED_SHARE * peak)
    before, after = fast[fast < minimum], fast[fast > minimum]
    begin = int(before[-1]) + 1 if len(before) else 0
    return slice(min(begin, minimum), max(int(after[0]) if len(after) else len(speed), minimum + 1))


def _nearest(times: Array, positions: Array, kept: Indices, place: Array, span: Array) -> int:
    """Return the index of the reading nearest to a place during a dwell."""
    inside = kept[(times[kept] >= span[0]) & (times[kept] <= span[1])]
    if not len(inside):
        inside = kept[[np.argmin(np.abs(times[kept] - span.mean()))]]
    return int(inside[np.argmin(np.linalg.norm(positions[inside] - place, axis=1))])
