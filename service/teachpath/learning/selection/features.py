"""What the consistency of demonstrations is judged by in mode default: course, shape, bends, smoothness."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.signal.windows import hamming

from teachpath.learning.resampling import arc_lengths, at_equal_arc_length, at_equal_times, smoothed
from teachpath.learning.selection.shape_residuals import COURSE_POINTS, courses
from teachpath.learning.settings import StepCallback
from teachpath.records import Array, Trajectory

WINDOW = 40  # samples of a stretch, or fewer when a demonstration is shorter
MIN_WINDOW = 20  # samples
TREND_DEGREE = 3  # degree of the polynomial that stands for the intended motion within a stretch
FFT_POINTS = 64  # points of the zero-padded transform
FREQUENCY_BANDS = ((1, 5), (5, 9), (9, 17), (17, 33))  # bins, first to one behind the last
NOISE_AMPLITUDE = 2e-4  # m, amplitude below which movement is not told from tracker noise
FEATURE_POINTS = 40  # equal times, or equal shares of the path, at which positions are taken
SHAPE_POINTS = 200  # points of a path that its bow is taken off
SHAPE_TREND_DEGREE = 5  # degree of the polynomial that stands for a path's large-scale form
VELOCITY_WEIGHT = 0.03  # s, weight of velocity beside position


@dataclass(frozen=True, eq=False)
class FeatureSet:
    """One kind of feature of every member of a cluster.

    Attributes:
        kind: what it tells: course, shape, bends or smoothness.
        sequences: for each member (frames, features).
        times: for each member (frames,) [s], when the frames are, since the first sample.
        states: of the models of it; 0 where the demonstrations are compared with one another without a model.
        core_scored: whether the consistent members of a cluster hardly differ in it.
    """

    kind: str
    sequences: list[Array]
    times: list[Array]
    states: int
    core_scored: bool = False


def extract_features(trajectories: Sequence[Trajectory], period: float, on_step: StepCallback) -> list[FeatureSet]:
    """Return the features of the members of a cluster; without smoothness when one is shorter than the window.

    Args:
        trajectories: of one cluster.
        period: sampling period [s] they are brought to for smoothness.
        on_step: called at most twice for each trajectory.
    """
    durations = [float(trajectory.times[-1] - trajectory.times[0]) for trajectory in trajectories]
    equal = [np.linspace(0.0, duration, FEATURE_POINTS) for duration in durations]
    paths = []
    for trajectory in trajectories:
        paths.append(smoothed(trajectory))
        on_step()
    found = [
        FeatureSet("course", positions_and_velocities(trajectories), equal, 10),
        FeatureSet("shape", shapes(paths), [_when(t, path) for t, path in zip(trajectories, paths, strict=True)], 10),
    ]
    instants = [np.linspace(0.0, duration, COURSE_POINTS) for duration in durations]
    found.append(FeatureSet("bends", courses(trajectories, paths), instants, 0))
    energies = band_energies(trajectories, period, on_step)
    if energies is not None:
        centres = [
            (np.arange(len(frames)) + 0.5) * duration / len(frames)
            for frames, duration in zip(energies, durations, strict=True)
        ]
        found.append(FeatureSet("smoothness", energies, centres, 5, core_scored=True))
    return found


def band_energies(trajectories: Sequence[Trajectory], period: float, on_step: StepCallback) -> list[Array] | None:
    """Return the log energy in four frequency bands of short stretches, freed of the intended motion.

    A cubic is taken off every stretch: the course of a hand over 0.8 s is nearly one, a wiggle of 1.5 Hz is not.
    The energy is summed over the axes, so it does not depend on the direction of the frame.

    Args:
        trajectories: of one cluster.
        period: sampling period [s] they are brought to.
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
        stretches = sliding_window_view(at_equal_times(trajectory, count), width, axis=0)[:: width // 5]
        residual = (stretches - (stretches @ trend) @ trend.T) * window  # (frames, 3, width)
        power = np.square(np.abs(np.fft.rfft(residual, FFT_POINTS, axis=2))).sum(axis=1)  # (frames, bins)
        energies = np.column_stack([power[:, low:high].sum(axis=1) for low, high in FREQUENCY_BANDS])
        features.append(np.log(energies + floor))
        on_step()
    return features


def positions_and_velocities(trajectories: Sequence[Trajectory]) -> list[Array]:
    """Return smoothed positions and weighted velocities at equal shares of each trajectory's duration.

    They are given along the principal axes of all positions, so they do not depend on the frame.

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
    """Return what is left of each path at equal arc length when its large-scale bow is taken off.

    Demonstrations of one way differ by bows, which say nothing; a local detour is no bow. Given along the principal
    axes of all, so it does not depend on the frame.

    Returns:
        for each path (40, 3) [m].
    """
    bow = np.linalg.qr(np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, SHAPE_POINTS), SHAPE_TREND_DEGREE))[0]
    stations = np.linspace(0, SHAPE_POINTS - 1, FEATURE_POINTS).round().astype(int)
    courses = [at_equal_arc_length(path, SHAPE_POINTS) for path in paths]
    residuals = [(course - bow @ (bow.T @ course))[stations] for course in courses]
    axes = np.linalg.eigh(np.cov(np.concatenate(residuals).T))[1]
    return [residual @ axes for residual in residuals]


def _when(trajectory: Trajectory, path: Array) -> Array:
    """Return the times [s] at which equal shares of a path are reached."""
    s = arc_lengths(path)
    return np.asarray(np.interp(np.linspace(0.0, s[-1], FEATURE_POINTS), s, trajectory.times - trajectory.times[0]))
