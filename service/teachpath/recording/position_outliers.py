"""Outliers of a hand's positions: single jumps, level shifts, and positions out of the workspace."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from teachpath.recording.settings import RecordingSettings
from teachpath.records import Array, Sample, SampleColumns

HALF_WINDOW = 3  # neighbours on each side
OUTLIER_THRESHOLD = 4.0  # standard deviations of the neighbours
TURN_BACK_COSINE = -0.5  # cosine of the angle between two steps, under which the second turns back
MAD_TO_SIGMA = 1.4826  # standard deviation over median absolute deviation, for a normal distribution


@dataclass(frozen=True, slots=True)
class PositionOutliers:
    """Outliers of the positions of a transport phase."""

    outliers: tuple[int, ...]  # numbers of the samples whose neighbours contradict them
    level_shifts: int  # places where the position jumps and stays
    out_of_workspace: int  # number of samples
    reversals: int = 0  # samples between which no hand could swing back and forth


def find_outliers(samples: Sequence[Sample], positions: Array, settings: RecordingSettings) -> PositionOutliers:
    """Find the outliers of a transport phase.

    A position is an outlier if its distance from the median of its neighbours is over `largest_jump` and over what
    their scatter explains (Hampel 1974). A level shift is a step between neighbours that exceeds the step that their
    speed explains by as much.

    Args:
        samples: in the order of their numbers, tracked.
        positions: of the hand (n, 3) [m, world].
    """
    low, high = np.array(settings.workspace_low), np.array(settings.workspace_high)
    out_of_workspace = int(np.count_nonzero(np.any((positions < low) | (positions > high), axis=1)))
    if len(positions) <= 2 * HALF_WINDOW:
        return PositionOutliers((), 0, out_of_workspace)
    away = np.linalg.norm(positions - _medians(positions), axis=1)
    outliers = _exceeds_scatter(away, settings.largest_jump)
    stayed = positions[~outliers]
    columns = SampleColumns.of(samples)
    times = (columns.device_ns - columns.device_ns[0])[~outliers] * 1e-9
    steps = np.linalg.norm(np.diff(stayed, axis=0), axis=1)
    dt = np.diff(times)
    if len(steps) <= 2 * HALF_WINDOW or np.any(dt <= 0):
        level_shifts = 0
    else:
        speed = _medians((steps / dt)[:, None])[:, 0]
        level_shifts = int(np.count_nonzero(_exceeds_scatter(steps - speed * dt, settings.largest_jump)))
    numbers = tuple(columns.sequence[outliers].tolist())
    return PositionOutliers(numbers, level_shifts, out_of_workspace, _count_reversals(stayed, dt, settings))


def _count_reversals(positions: Array, dt: Array, settings: RecordingSettings) -> int:
    """Count the samples at which a hand would turn back by over `largest_jump`, faster than `largest_acceleration`.

    The samples of two hands under one name do so wherever one follows the other.
    """
    steps = np.diff(positions, axis=0)
    if len(steps) < 2 or np.any(dt <= 0):
        return 0
    lengths, velocities = np.linalg.norm(steps, axis=1), steps / dt[:, None]
    far = (lengths[1:] > settings.largest_jump) & (lengths[:-1] > settings.largest_jump)
    opposite = np.sum(steps[1:] * steps[:-1], axis=1) < TURN_BACK_COSINE * lengths[1:] * lengths[:-1]
    acceleration = np.linalg.norm(np.diff(velocities, axis=0), axis=1) / (0.5 * (dt[1:] + dt[:-1]))
    return int(np.count_nonzero(far & opposite & (acceleration > settings.largest_acceleration)))


def _medians(values: Array) -> Array:
    """Return the median of each value and its neighbours, axis by axis: (n, d)."""
    # An odd reflection keeps a hand that moves evenly where it is, at the ends too.
    padded = np.pad(values, ((HALF_WINDOW, HALF_WINDOW), (0, 0)), mode="reflect", reflect_type="odd")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * HALF_WINDOW + 1, axis=0)
    return np.asarray(np.partition(windows, HALF_WINDOW, axis=-1)[..., HALF_WINDOW])


def _exceeds_scatter(away: Array, floor: float) -> NDArray[np.bool_]:
    """Tell which distances (n,) are over `floor` and over the scatter of their neighbours."""
    scatter = MAD_TO_SIGMA * _medians(np.abs(away)[:, None])[:, 0]
    return np.asarray(away > np.maximum(floor, OUTLIER_THRESHOLD * scatter))
