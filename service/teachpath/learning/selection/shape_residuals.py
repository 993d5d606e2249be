"""Excess bending: what differs from the other demonstrations of a cluster in neither pace nor slow drift.

Demonstrations of one cluster differ in pace and by slow drifts without being inconsistent, and both are smooth. So each
course is compared with the mean of the others after its time is warped by a few sines. A polynomial of low degree
stands for the drift; a detour shows as energy in the degrees above it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teachpath.records import Array

WARP_SINES = 3  # that warp the time of a course
DRIFT_DEGREE = 5  # highest degree that counts as drift while the warp is fitted
WARP_SCALE = 0.01  # share of the length of the path; a larger shift by the warp counts as unlikely
GAUSS_NEWTON_STEPS = 4
MIN_DEGREE, END_DEGREE = 4, 9  # degrees whose energy counts, first to one behind the last
ENERGY_EXPONENT = 8  # power of the degree by which the energy of a smooth hand falls
NEGLIGIBLE_BEND = 0.001  # of the size of the path, root mean square; bends far below it say nothing
TRIM_RATIO = 8  # of so many others, the one that bends most does not count
MIN_COURSES = 4  # of which three tell the usual energy


@dataclass(frozen=True, eq=False)
class Bending:
    """What of m courses neither pace nor slow drift explains.

    Attributes:
        energies: (m, degrees) mean squares in the degrees that count, in squared sizes of the path.
        warps: (m,) shares of the duration by which the pace of a course differs from that of the others.
    """

    energies: Array
    warps: Array

    @property
    def amplitudes(self) -> Array:
        """Root mean squares of the bends: (m,) in sizes of the path."""
        return np.asarray(np.sqrt(self.energies.sum(axis=1)))


def measure_bending(shown: Array, size: float) -> Bending:
    """Compare every course with the mean of the others.

    Args:
        shown: (m, n, 3) [m] at n equal shares of the duration, m at least 4.
        size: of the path [m].
    """
    m, n, _ = shown.shape
    means = (shown.sum(axis=0) - shown) / (m - 1)
    residuals, polynomials, warps = _residuals(shown, means)
    coefficients = polynomials[:, :, MIN_DEGREE:END_DEGREE].transpose(0, 2, 1) @ residuals  # (m, degrees, 3)
    energies = np.square(coefficients).sum(axis=2) / (n * size**2)
    return Bending(energies, np.linalg.norm(warps, axis=1))


def bending_surprises(energies: Array) -> Array:
    """Return how much more each course bends than the others, whose energy falls as a smooth hand's: (m,) nats."""
    degrees = np.arange(MIN_DEGREE, END_DEGREE)
    even = NEGLIGIBLE_BEND**2 / len(degrees)
    weighted = (energies + even) * (degrees / MIN_DEGREE) ** float(ENERGY_EXPONENT)
    return np.asarray(np.log1p(weighted / (3 * _usual(weighted.mean(axis=1))[:, None])).sum(axis=1))


def _usual(energies: Array) -> Array:
    """Return for each course the mean energy of the others, without the largest of them: (m,)."""
    m = len(energies)
    kept = m - 1 - (m - 1) // TRIM_RATIO
    order = np.sort(energies)
    # Of all, the least but one more than are kept; without its own, or else without the largest of them.
    return np.asarray((order[: kept + 1].sum() - np.minimum(energies, order[kept])) / kept)


def _residuals(shown: Array, means: Array) -> tuple[Array, Array, Array]:
    """Warp the time of every course onto its mean by Gauss and Newton's method, and subtract the mean.

    Returns:
        (m, n, 3) [m] residuals; (m, n, degrees) polynomials in the share of the path of the mean, orthonormal over the
        n points; (m, sines) the warps, in shares of the duration.
    """
    m, n, _ = shown.shape
    steps = np.linalg.norm(np.diff(means, axis=1), axis=2)
    share = np.concatenate([np.zeros((m, 1)), np.cumsum(steps, axis=1)], axis=1)
    length = share[:, -1].copy()
    share /= np.maximum(length, 1e-12)[:, None]
    polynomials = np.linalg.qr(np.polynomial.legendre.legvander(2 * share - 1, END_DEGREE - 1))[0]
    drift = polynomials[:, :, : DRIFT_DEGREE + 1]
    sines = np.sin(np.pi * np.outer(np.linspace(0.0, 1.0, n), np.arange(1, WARP_SINES + 1)))
    stiffness = n * np.square(WARP_SCALE * length)[:, None] + 1e-12
    warp = np.zeros((m, WARP_SINES))
    for _ in range(GAUSS_NEWTON_STEPS):
        course = _shifted(shown, warp @ sines.T)
        rate = np.gradient(course, axis=1) * (n - 1)
        slopes = [rate * sine[:, None] for sine in sines.T]  # of the course by each coefficient of the warp
        free = np.concatenate([course - means, *slopes], axis=2)  # (m, n, 3 + 3 sines)
        free = (free - drift @ (drift.transpose(0, 2, 1) @ free)).reshape(m, n, WARP_SINES + 1, 3)
        flat = free.transpose(0, 2, 1, 3).reshape(m, WARP_SINES + 1, -1)
        products = flat @ flat.transpose(0, 2, 1)
        normal = products[:, 1:, 1:] + stiffness[..., None] * np.eye(WARP_SINES)
        warp = warp - np.linalg.solve(normal, (products[:, 1:, 0] + stiffness * warp)[..., None])[..., 0]
    return _shifted(shown, warp @ sines.T) - means, polynomials, warp


def _shifted(shown: Array, shift: Array) -> Array:
    """Interpolate courses at times that are later by shares (m, n) of the duration."""
    m, n, _ = shown.shape
    at = np.clip((np.linspace(0.0, 1.0, n) + shift) * (n - 1), 0.0, n - 1)
    before = np.minimum(at.astype(int), n - 2)
    part = (at - before)[..., None]
    rows = np.arange(m)[:, None]
    return np.asarray((1 - part) * shown[rows, before] + part * shown[rows, before + 1])
