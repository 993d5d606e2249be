"""What the consistency of demonstrations is measured on: their course, shape, bending and smoothness."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.signal.windows import hamming

from teachpath.learning.resampling import arc_lengths, at_equal_arc_length, at_equal_times, smoothed
from teachpath.learning.settings import StepCallback
from teachpath.records import Array, Trajectory

WINDOW = 40  # samples of a spectrum, or fewer when a demonstration is shorter
MIN_WINDOW = 20  # samples
TREND_DEGREE = 3  # of the polynomial that stands for the intended motion within a window
FFT_POINTS = 64  # of the zero-padded transform
FREQUENCY_BANDS = ((1, 5), (5, 9), (9, 17), (17, 33))  # bins, first to one behind the last
NOISE_AMPLITUDE = 2e-4  # m, below which motion is not told from tracker noise
FEATURE_POINTS = 40  # equal times, or equal shares of the path, at which course and shape are sampled
BENDING_POINTS = 100  # equal times at which a course is sampled for its bending
SHAPE_POINTS = 200  # of a path while its large-scale form is subtracted
SHAPE_TREND_DEGREE = 5  # of the polynomial that stands for the large-scale form of a path
VELOCITY_WEIGHT = 0.03  # s, of velocity beside position


class Feature(StrEnum):
    """A kind of feature in which demonstrations of one cluster are compared."""

    COURSE = "course"  # where the hand is at which time
    SHAPE = "shape"  # the path at equal arc length, without its large-scale form
    BENDING = "bending"  # what neither pace nor slow drift explains
    SMOOTHNESS = "smoothness"  # energy in frequency bands, without the intended motion


@dataclass(frozen=True, eq=False)
class FeatureSet:
    """One kind of feature of every member of a cluster.

    Attributes:
        sequences: for each member (frames, features).
        times: for each member (frames,) [s] since its first sample.
    """

    sequences: list[Array]
    times: list[Array]


def extract_features(
    trajectories: Sequence[Trajectory], period: float, on_step: StepCallback
) -> dict[Feature, FeatureSet]:
    """Compute the features of the members of a cluster.

    Args:
        trajectories: of one cluster.
        period: sampling period [s] of the spectra.
        on_step: called at most twice for each trajectory.

    Returns:
        course, shape, bending and smoothness; smoothness is missing when a demonstration is shorter than its window.
    """
    durations = [float(trajectory.times[-1] - trajectory.times[0]) for trajectory in trajectories]
    paths = []
    for trajectory in trajectories:
        paths.append(smoothed(trajectory))
        on_step()
    found = {
        Feature.COURSE: FeatureSet(positions_and_velocities(trajectories), _even_times(durations, FEATURE_POINTS)),
        Feature.SHAPE: FeatureSet(
            shapes(paths), [_passing_times(t, path) for t, path in zip(trajectories, paths, strict=True)]
        ),
        Feature.BENDING: FeatureSet(courses(trajectories, paths), _even_times(durations, BENDING_POINTS)),
    }
    energies = band_energies(trajectories, period, on_step)
    if energies is not None:
        centres = [
            (np.arange(len(frames)) + 0.5) * duration / len(frames)
            for frames, duration in zip(energies, durations, strict=True)
        ]
        found[Feature.SMOOTHNESS] = FeatureSet(energies, centres)
    return found


def band_energies(trajectories: Sequence[Trajectory], period: float, on_step: StepCallback) -> list[Array] | None:
    """Compute the log energy in four frequency bands in short windows, without the intended motion.

    A cubic polynomial is subtracted in every window: the intended motion of a hand over 0.8 s is nearly a cubic, a
    wiggle of 1.5 Hz is not. The energy is summed over the axes, so it does not depend on the direction of the frame.

    Args:
        trajectories: of one cluster.
        period: sampling period [s] to which they are resampled.
        on_step: called once for each trajectory.

    Returns:
        for each trajectory (frames, 4), or None when one is shorter than 20 periods.
    """
    counts = [round(float(trajectory.times[-1] - trajectory.times[0]) / period) + 1 for trajectory in trajectories]
    width = min(WINDOW, *counts)
    if width < MIN_WINDOW:
        return None
    window = hamming(width)
    trend = np.linalg.qr(np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, width), TREND_DEGREE))[0]
    floor = np.square(NOISE_AMPLITUDE * window.sum() / 2)
    features = []
    for trajectory, count in zip(trajectories, counts, strict=True):
        windows = sliding_window_view(at_equal_times(trajectory, count), width, axis=0)[:: width // 5]
        residual = (windows - (windows @ trend) @ trend.T) * window  # (frames, 3, width)
        power = np.square(np.abs(np.fft.rfft(residual, FFT_POINTS, axis=2))).sum(axis=1)  # (frames, bins)
        energies = np.column_stack([power[:, low:high].sum(axis=1) for low, high in FREQUENCY_BANDS])
        features.append(np.log(energies + floor))
        on_step()
    return features


def positions_and_velocities(trajectories: Sequence[Trajectory]) -> list[Array]:
    """Sample smoothed positions and weighted velocities at equal shares of each trajectory's duration.

    The axes are the principal axes of all positions, so the features do not depend on the frame.

    Returns:
        for each trajectory (40, 6) [m].
    """
    courses = [at_equal_times(trajectory, FEATURE_POINTS, smoothed(trajectory)) for trajectory in trajectories]
    pooled = np.concatenate(courses)
    centre = pooled.mean(axis=0)
    axes = np.linalg.eigh(np.cov((pooled - centre).T))[1]
    features = []
    for trajectory, course in zip(trajectories, courses, strict=True):
        local = (course - centre) @ axes
        step = float(trajectory.times[-1] - trajectory.times[0]) / (FEATURE_POINTS - 1)
        features.append(np.column_stack([local, VELOCITY_WEIGHT * np.gradient(local, step, axis=0)]))
    return features


def shapes(paths: Sequence[Array]) -> list[Array]:
    """Sample each path at equal arc length and subtract its large-scale form, a polynomial of degree 5.

    Demonstrations of one cluster differ in their large-scale form without being inconsistent; a local detour is no
    part of it. The axes are the principal axes of all residuals, so the features do not depend on the frame.

    Returns:
        for each path (40, 3) [m].
    """
    trend = np.linalg.qr(np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, SHAPE_POINTS), SHAPE_TREND_DEGREE))[0]
    stations = np.linspace(0, SHAPE_POINTS - 1, FEATURE_POINTS).round().astype(int)
    courses = [at_equal_arc_length(path, SHAPE_POINTS) for path in paths]
    residuals = [(course - trend @ (trend.T @ course))[stations] for course in courses]
    axes = np.linalg.eigh(np.cov(np.concatenate(residuals).T))[1]
    return [residual @ axes for residual in residuals]


def courses(trajectories: Sequence[Trajectory], paths: Sequence[Array]) -> list[Array]:
    """Sample smoothed paths at equal shares of their durations: for each (100, 3) [m]."""
    return [at_equal_times(t, BENDING_POINTS, path) for t, path in zip(trajectories, paths, strict=True)]


def _even_times(durations: Sequence[float], count: int) -> list[Array]:
    return [np.linspace(0.0, duration, count) for duration in durations]


def _passing_times(trajectory: Trajectory, path: Array) -> Array:
    """Return the times [s] at which the hand passes equal shares of its path."""
    s = arc_lengths(path)
    return np.asarray(np.interp(np.linspace(0.0, s[-1], FEATURE_POINTS), s, trajectory.times - trajectory.times[0]))
