"""What the consistency of demonstrations is judged by in mode default: band energies, positions, velocities."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.signal.windows import hamming

from teachpath.learning.resampling import at_equal_times, smoothed
from teachpath.records import Array, Trajectory

WINDOW = 40  # samples of a stretch, or fewer when a demonstration is shorter
LEAST_WINDOW = 20  # samples
TREND = 3  # degree of the polynomial that stands for the intended motion within a stretch
SPECTRUM = 64  # points of the zero-padded transform
BANDS = ((1, 5), (5, 9), (9, 17), (17, 33))  # bins, first to one behind the last
QUIET = 2e-4  # m, amplitude below which movement is not told from tracker noise
INSTANTS = 40  # equal times at which position and velocity are taken
LEAD = 0.03  # s, weight of velocity beside position


def band_energies(trajectories: Sequence[Trajectory], period: float) -> list[Array] | None:
    """Return the log energy in four frequency bands of short stretches, freed of the intended motion.

    A cubic is taken off every stretch: the course of a hand over 0.8 s is nearly one, a wiggle of 1.5 Hz is not.
    The energy is summed over the axes, so it does not depend on the direction of the frame.

    Args:
        trajectories: of one cluster.
        period: sampling period [s] they are brought to.

    Returns:
        for each trajectory (frames, 4), or None when one is shorter than 20 periods.
    """
    counts = [round(float(trajectory.times[-1] - trajectory.times[0]) / period) + 1 for trajectory in trajectories]
    width = min(WINDOW, *counts)
    if width < LEAST_WINDOW:
        return None
    window = hamming(width)
    trend = np.linalg.qr(np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, width), TREND))[0]
    floor = np.square(QUIET * window.sum() / 2)
    features = []
    for trajectory, count in zip(trajectories, counts, strict=True):
        stretches = sliding_window_view(at_equal_times(trajectory, count), width, axis=0)[:: width // 5]
        residual = (stretches - (stretches @ trend) @ trend.T) * window  # (frames, 3, width)
        power = np.square(np.abs(np.fft.rfft(residual, SPECTRUM, axis=2))).sum(axis=1)  # (frames, bins)
        energies = np.column_stack([power[:, low:high].sum(axis=1) for low, high in BANDS])
        features.append(np.log(energies + floor))
    return features


def positions_and_velocities(trajectories: Sequence[Trajectory]) -> list[Array]:
    """Return smoothed positions and weighted velocities at equal shares of each trajectory's duration.

    They are given along the principal axes of all positions, so they do not depend on the frame.

    Returns:
        for each trajectory (40, 6) [m].
    """
    courses = [at_equal_times(trajectory, INSTANTS, smoothed(trajectory)) for trajectory in trajectories]
    pooled = np.concatenate(courses)
    centre = pooled.mean(axis=0)
    axes = np.linalg.eigh(np.cov((pooled - centre).T))[1]
    features = []
    for trajectory, course in zip(trajectories, courses, strict=True):
        local = (course - centre) @ axes
        step = float(trajectory.times[-1] - trajectory.times[0]) / (INSTANTS - 1)
        features.append(np.column_stack([local, LEAD * np.gradient(local, step, axis=0)]))
    return features
