"""Readings that repeat the one before while the hand moves: a frozen tracker, or one slower than its samples.

A resting hand repeats readings as well. What tells it from a tracker that does not measure is the motion around it: a
resting hand has slowed down before and speeds up after, a tracker stops at full speed and goes on with a leap.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from teachpath.records import Array, Sample, SampleColumns

NEIGHBOURS = 4  # steps before and after that tell how fast the hand was
FREEZE_LENGTH = 3  # repeats in a row; fewer are judged by the motion on both sides alone
REPEAT_NOISE = 0.2  # standard deviations of the noise; a shorter step is a repeat
NOISE_FLOOR = 6.0  # standard deviations of the noise; a shorter step shows no motion
LATTICE_FLOOR = 3.0  # steps of the device's resolution, likewise
MOTION_FLOOR = 0.1  # of the upper quartile of the steps, likewise
ABRUPT_STEP_SHARE = 0.3  # of the largest step before; a hand that comes to rest takes a shorter last step
RETURN_SHARE = 0.3  # of the way that the hand would have gone at its speed before; a hand that stopped goes none of it
SAME_ORIENTATION = 1.0 - 1e-12  # scalar product of two quaternions, over which they are the same
LOWEST_QUARTER = 1.1011  # lowest quartile of the length of a normal vector in space, in standard deviations
THIRD_DIFFERENCE = np.sqrt(20.0)  # standard deviation of third differences of white noise


@dataclass(frozen=True, slots=True)
class RepeatedReadings:
    """Which readings of a span repeat the one before although the hand moved.

    Attributes:
        indices: of them, rising.
        longest: [s] longest time for which one reading stood instead of the next ones; 0: none was repeated.
        longest_at: index of that reading.
        measured_rate: [Hz] readings that differ, where the hand moved; 0: it never did.
    """

    indices: tuple[int, ...] = ()
    longest: float = 0.0
    longest_at: int = 0
    measured_rate: float = 0.0


def find_repeated_readings(samples: Sequence[Sample], begin: int, end: int) -> RepeatedReadings:
    """Find the repeated readings of a span.

    Args:
        samples: tracked, in the order of their numbers; those around the span tell whether the hand moved.
        begin: first index of the span.
        end: first index after it.
    """
    columns = SampleColumns.of(samples)
    times = (columns.device_ns - columns.device_ns[0]) * 1e-9
    measured = columns.orientation.any(axis=1).all()
    return find_repeated(times, columns.position, columns.orientation if measured else None, begin, end)


def find_repeated(times: Array, positions: Array, orientations: Array | None, begin: int, end: int) -> RepeatedReadings:
    """Find the repeated readings of a span, of arrays.

    Args:
        times: (n,) [s], rising.
        positions: (n, 3) [m], any frame.
        orientations: (n, 4) or None; a reading that turns does not repeat.
        begin: first index of the span; readings around it tell whether the hand moved.
        end: first index after it.
    """
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    if end - begin <= NEIGHBOURS or not steps.any():
        return RepeatedReadings()
    changed = positions[np.concatenate([[True], steps > 0.0])]
    sigma = _noise(changed)
    floor = _motion_floor(changed, sigma)
    still = steps <= REPEAT_NOISE * sigma
    if orientations is not None:
        still &= np.abs(np.sum(orientations[1:] * orientations[:-1], axis=1)) > SAME_ORIENTATION
    runs = [run for run in _runs(still) if run[0] < end - 1 and run[1] >= begin]
    stale = [run for run in runs if _is_stale(times, steps, still, *run, floor)]
    indices = [k + 1 for a, b in stale for k in range(a, b) if begin <= k + 1 < end]
    if not indices:
        return RepeatedReadings()
    spans = [(float(times[min(b + 1, len(times) - 1)] - times[a]), a) for a, b in stale]
    longest, at = max(spans)
    rate = _measured_rate(times[begin:end], steps[begin : end - 1], len(indices), floor)
    return RepeatedReadings(tuple(indices), longest, at, rate)


def _noise(changed: Array) -> float:
    """Return the standard deviation of one coordinate's noise [m]."""
    if len(changed) < 2 * NEIGHBOURS:
        return 0.0
    third = np.linalg.norm(np.diff(changed, n=3, axis=0), axis=1)
    return float(np.quantile(third, 0.25) / LOWEST_QUARTER / THIRD_DIFFERENCE)


def _motion_floor(changed: Array, sigma: float) -> float:
    steps = np.linalg.norm(np.diff(changed, axis=0), axis=1)
    along = np.abs(np.diff(changed, axis=0))
    lattice = float(np.quantile(along[along > 0.0], 0.05)) if along.any() else 0.0
    return max(NOISE_FLOOR * sigma, LATTICE_FLOOR * lattice, MOTION_FLOOR * float(np.quantile(steps, 0.75)))


def _runs(still: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the runs of steps without motion, the first step of each and the first after it."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]])))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def _is_stale(times: Array, steps: Array, still: NDArray[np.bool_], a: int, b: int, floor: float) -> bool:
    """Tell whether the hand moved while the steps from `a` to before `b` show no motion."""
    before, after = steps[:a][~still[:a]][-NEIGHBOURS:], steps[b:][~still[b:]][:NEIGHBOURS]
    if not len(before) or before.max() <= floor:
        return False
    if b - a < FREEZE_LENGTH:
        return bool(len(after) and after.max() > floor)
    stopped = before[-1] > max(floor, ABRUPT_STEP_SHARE * before.max())
    if not len(after):
        return bool(stopped)
    begun = int(np.flatnonzero(~still[:a])[-NEIGHBOURS:][0])
    went, missed = float(steps[begun:a].sum()), float(times[b + 1] - times[a])
    return bool(stopped and steps[b] > floor and steps[b] * (times[a] - times[begun]) > RETURN_SHARE * missed * went)


def _measured_rate(times: Array, steps: Array, repeated: int, floor: float) -> float:
    moving = int(np.count_nonzero(steps > floor)) + repeated
    duration = float(times[-1] - times[0])
    rate = (len(times) - 1) / duration if duration > 0.0 else 0.0
    return rate * (moving - repeated) / moving
