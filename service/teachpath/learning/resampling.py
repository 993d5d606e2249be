"""Smoothing and resampling of trajectories: at equal arc length, at equal times, or at random."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.spatial.distance import pdist

from teachpath.records import Array, Trajectory

SMOOTHING_WINDOW = 0.18  # s, width of the moving average: nine samples of a 50 Hz tracker
EXTENT_POINTS = 60  # of a path, whose distances tell its size


def smoothed(trajectory: Trajectory) -> Array:
    """Average a trajectory over a short moving window; the first and the last position stay exact.

    Returns:
        (n, 3) [m].
    """
    return _averaged(trajectory.positions, trajectory.times)


def smoothed_orientations(times: Array, orientations: Array) -> Array:
    """Average orientations over the same window: (n, 4) unit quaternions, neighbours on one half of the sphere."""
    averaged = _averaged(sign_aligned(orientations), times)
    return np.asarray(averaged / np.linalg.norm(averaged, axis=1, keepdims=True))


def sign_aligned(orientations: Array) -> Array:
    """Flip the signs of quaternions so that neighbours lie on one half of the sphere; the rotations stay the same."""
    turns = np.where((orientations[1:] * orientations[:-1]).sum(axis=1) < 0, -1.0, 1.0)
    return np.asarray(orientations * np.concatenate([[1.0], np.cumprod(turns)])[:, None])


def arc_lengths(path: Array) -> Array:
    """Return the arc length from the start at every point of a polyline: (n,) [m]."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])


def extent(path: Array) -> float:
    """Return the size of a path: the largest distance [m] of two of some sixty of its points."""
    return float(pdist(path[np.linspace(0, len(path) - 1, EXTENT_POINTS).astype(int)]).max())


def at_equal_arc_length(path: Array, count: int) -> Array:
    """Return `count` points at equal arc length along a polyline: (count, 3) [m], both ends exact."""
    s = arc_lengths(path)
    forward = np.concatenate([[True], np.diff(s) > 0])
    return _interpolated(np.linspace(0.0, s[-1], count), s[forward], path[forward])


def at_equal_times(trajectory: Trajectory, count: int, positions: Array | None = None) -> Array:
    """Interpolate the positions, or other values at the same times, at `count` equal times: (count, 3) [m]."""
    times = trajectory.times
    values = trajectory.positions if positions is None else positions
    return _interpolated(np.linspace(times[0], times[-1], count), times, values)


def undersampled(positions: Array, count: int, rng: np.random.Generator) -> Array:
    """Keep `count` positions drawn at random without replacement, in their order (Aleotti & Caselli, III-A)."""
    return positions[np.sort(rng.choice(len(positions), count, replace=False))]


def _averaged(values: Array, times: Array) -> Array:
    # Without the quarter, rounding would choose between two windows at whole sampling rates.
    half = int(SMOOTHING_WINDOW / float(np.median(np.diff(times))) / 2 + 0.25)
    half = min(half, (len(values) - 1) // 2)
    if half == 0:
        return values
    # An odd reflection about each end point preserves the point and the direction of motion there.
    before = 2 * values[0] - values[half:0:-1]
    after = 2 * values[-1] - values[-2 : -half - 2 : -1]
    extended = np.concatenate([before, values, after])
    averaged: Array = uniform_filter1d(extended, 2 * half + 1, axis=0)[half:-half]
    averaged[[0, -1]] = values[[0, -1]]
    return averaged


def _interpolated(at: Array, knots: Array, values: Array) -> Array:
    return np.column_stack([np.interp(at, knots, values[:, axis]) for axis in range(values.shape[1])])
