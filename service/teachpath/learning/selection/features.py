"""What the consistency of a demonstration is measured on: its motion on two clocks, its dwell times, its readings.

Amounts are later taken as shares of the size of the path, and times as shares of the duration, so neither the size of a
task nor the sampling rate matters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter

from teachpath.learning.resampling import arc_lengths, at_equal_times, smoothed
from teachpath.records import Array, Trajectory

CLOCK_POINTS = 240  # equal shares of the duration, or of the path, over which positions are averaged
DEGREES = 101  # of the Legendre polynomials that describe a motion on a clock
PATH_PARTS = 24  # equal parts of the path whose durations are compared
COURSE_POINTS = 40  # equal times at which a course is sampled for the hidden Markov model
VELOCITY_WEIGHT = 0.03  # s, of velocity beside position
MEDIAN_WINDOW = 7  # readings, from whose median a single one may jump
MIN_REPEATS = 4  # exact repeats of a reading, from which on a tracker may have frozen

_EDGES = np.linspace(-1.0, 1.0, CLOCK_POINTS + 1)
# Orthonormal over the points of a clock, so that squared coefficients sum to energies.
POLYNOMIALS: Array = np.linalg.qr(np.polynomial.legendre.legvander((_EDGES[1:] + _EDGES[:-1]) / 2, DEGREES - 1))[
    0
] * np.sqrt(CLOCK_POINTS)
POLYNOMIALS_BY_DEGREE: Array = np.ascontiguousarray(POLYNOMIALS.T)


@dataclass(frozen=True, eq=False)
class MotionFeatures:
    """What is measured of one demonstration.

    Attributes:
        duration: [s].
        path: (n, 3) [m] smoothed positions.
        timed: (101, 3) [m] Legendre coefficients over the share of the duration; their squares sum to mean squares.
        spaced: (101, 3) [m] the same over the share of the path.
        passing: (25,) [s] times at which the hand passes equal shares of its path.
        jump: [m] largest distance of a reading from the median of the seven around it.
        jump_at: number of that reading.
        leap: [m] largest leap that ends a run of repeated readings; 0 when there is none.
        frozen: first and last number of that run.
    """

    duration: float
    path: Array
    timed: Array
    spaced: Array
    passing: Array
    jump: float
    jump_at: int
    leap: float
    frozen: tuple[int, int]


def extract_features(trajectory: Trajectory) -> MotionFeatures:
    """Measure one demonstration."""
    since = trajectory.times - trajectory.times[0]
    positions = trajectory.positions
    path = smoothed(trajectory)
    s = arc_lengths(path)
    forward = np.concatenate([[True], np.diff(s) > 0])
    forward[-1] = True
    # Where the hand rests its path has no length; the times in between are left out.
    shares = np.linspace(0.0, s[-1], CLOCK_POINTS + 1)
    at_shares = np.interp(shares, s[forward], since[forward])
    at_shares[0], at_shares[-1] = 0.0, since[-1]
    # A median of each coordinate depends on the axes: the motion's own ones make it the same in every frame.
    centred = positions - positions.mean(axis=0)
    axes = np.linalg.eigh(np.einsum("ni,nj->ij", centred, centred))[1]
    local = np.einsum("ni,ij->nj", centred, axes)
    departures = np.linalg.norm(local - median_filter(local, size=(MEDIAN_WINDOW, 1), mode="nearest"), axis=1)
    leap, frozen = _largest_leap(positions)
    return MotionFeatures(
        duration=float(since[-1]),
        path=path,
        timed=_coefficients(since, positions, np.linspace(0.0, since[-1], CLOCK_POINTS + 1)),
        spaced=_coefficients(since, positions, at_shares),
        passing=at_shares[:: CLOCK_POINTS // PATH_PARTS],
        jump=float(departures.max()),
        jump_at=int(np.argmax(departures)),
        leap=leap,
        frozen=frozen,
    )


def positions_and_velocities(trajectories: Sequence[Trajectory], paths: Sequence[Array] | None = None) -> list[Array]:
    """Sample smoothed positions and weighted velocities at equal shares of each trajectory's duration.

    The axes are the principal axes of all positions, so the features do not depend on the frame.

    Args:
        trajectories: of the members.
        paths: their smoothed positions, where they are known already.

    Returns:
        for each trajectory (40, 6) [m].
    """
    known = map(smoothed, trajectories) if paths is None else paths
    courses = [at_equal_times(each, COURSE_POINTS, path) for each, path in zip(trajectories, known, strict=True)]
    pooled = np.concatenate(courses)
    centre = pooled.mean(axis=0)
    axes = np.linalg.eigh(np.cov((pooled - centre).T))[1]
    features = []
    for trajectory, course in zip(trajectories, courses, strict=True):
        local = (course - centre) @ axes
        step = float(trajectory.times[-1] - trajectory.times[0]) / (COURSE_POINTS - 1)
        features.append(np.column_stack([local, VELOCITY_WEIGHT * np.gradient(local, step, axis=0)]))
    return features


def _coefficients(since: Array, positions: Array, edges: Array) -> Array:
    """Average positions over time between edges (241,) [s], and project them on the polynomials: (101, 3) [m]."""
    steps = np.diff(since)
    integral = np.concatenate(
        [np.zeros((1, 3)), np.cumsum((positions[1:] + positions[:-1]) / 2 * steps[:, None], axis=0)]
    )
    k = np.clip(np.searchsorted(since, edges, side="right") - 1, 0, len(steps) - 1)
    after = (edges - since[k])[:, None]
    slopes = (positions[k + 1] - positions[k]) / steps[k, None]
    at_edges = integral[k] + positions[k] * after + slopes * np.square(after) / 2
    widths = np.diff(edges)[:, None]
    instant = widths <= 1e-9 * since[-1]  # an edge of a leap: its position instead of an average
    averages = np.where(
        instant, (positions[k] + slopes * after)[:-1], np.diff(at_edges, axis=0) / np.where(instant, 1.0, widths)
    )
    # A matrix product would round differently with another number of threads. Sums along rows are the quickest.
    return np.asarray(np.einsum("dn,kn->dk", POLYNOMIALS_BY_DEGREE, np.ascontiguousarray(averages.T)) / CLOCK_POINTS)


def _largest_leap(positions: Array) -> tuple[float, tuple[int, int]]:
    """Return the largest leap [m] after a run of exact repeats, and the readings of the run."""
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    edges = np.diff(np.concatenate([[0], np.asarray(steps == 0, dtype=int), [0]]))
    begins, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    kept = (ends - begins >= MIN_REPEATS) & (ends < len(steps))
    begins, ends = begins[kept], ends[kept]
    if not len(begins):
        return 0.0, (0, 0)
    largest = int(np.argmax(steps[ends]))
    return float(steps[ends[largest]]), (int(begins[largest]), int(ends[largest]))
