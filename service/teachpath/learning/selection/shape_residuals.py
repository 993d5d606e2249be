"""Excess bending: what differs from the other demonstrations of a cluster in neither pace nor slow drift.

Demonstrations of one cluster differ in pace and by slow drifts without being inconsistent, and both are smooth. So each
course is compared with the mean of the others after its time is warped by a few sines. A polynomial of low degree
stands for the drift; a detour shows as energy in the degrees above it.
"""

from __future__ import annotations

import numpy as np

from teachpath.records import Array

WARP_SINES = 3  # that warp the time of a course
DRIFT_DEGREE = 5  # highest degree that counts as drift while the warp is fitted
WARP_SCALE = 0.01  # share of the length of the path; a larger shift by the warp counts as unlikely
GAUSS_NEWTON_STEPS = 4
MIN_DEGREE, END_DEGREE = 4, 9  # degrees whose energy counts, first to one behind the last
ENERGY_EXPONENT = 8  # power of the degree by which the energy of a smooth hand falls
TRIM_RATIO = 8  # of so many others, the one that bends most does not count
MIN_COURSES = 4  # of which three tell the usual energy
SURPRISE_ALLOWANCE = 2.2  # nats that count as usual
Z_PER_NAT = 10.0  # above the allowance: one of twenty clean ones among five then exceeds the limit of z


def score_bending(shown: Array) -> tuple[Array, Array]:
    """Compare every course with the mean of the others.

    Args:
        shown: (m, n, 3) [m] at n equal shares of the duration.

    Returns:
        (m,) z of the excess bending, at most 0, and 0 for fewer than four courses; (m, n) log-likelihoods of the
        points of each course, up to a constant.
    """
    m, n, _ = shown.shape
    if m < MIN_COURSES:
        return np.zeros(m), np.zeros((m, n))
    means = (shown.sum(axis=0) - shown) / (m - 1)
    residuals, polynomials = _residuals(shown, means)
    counted = polynomials[:, :, MIN_DEGREE:END_DEGREE]
    coefficients = counted.transpose(0, 2, 1) @ residuals  # (m, degrees, 3)
    energies = np.square(coefficients).sum(axis=2) * np.arange(MIN_DEGREE, END_DEGREE) ** float(ENERGY_EXPONENT)
    usual = _usual(energies.mean(axis=1))
    surprise = np.log1p(energies / (3 * usual[:, None])).sum(axis=1)
    bending = counted @ coefficients
    spread = np.square(bending).sum(axis=2).mean(axis=1)
    profiles = -0.5 * np.square(bending).sum(axis=2) / np.maximum(_usual(spread), 1e-12)[:, None]
    return -Z_PER_NAT * np.maximum(surprise - SURPRISE_ALLOWANCE, 0.0), profiles


def _usual(energies: Array) -> Array:
    """Return for each course the mean energy of the others, without the largest of them: (m,)."""
    m = len(energies)
    others = np.sort(np.broadcast_to(energies, (m, m))[~np.eye(m, dtype=bool)].reshape(m, m - 1), axis=1)
    return np.asarray(others[:, : max(m - 1 - (m - 1) // TRIM_RATIO, 1)].mean(axis=1)) + 1e-12


def _residuals(shown: Array, means: Array) -> tuple[Array, Array]:
    """Warp the time of every course onto its mean by Gauss and Newton's method, and subtract the mean.

    Returns:
        (m, n, 3) [m] residuals; (m, n, degrees) polynomials in the share of the path of the mean, orthonormal over the
        n points.
    """
    m, n, _ = shown.shape
    steps = np.linalg.norm(np.diff(means, axis=1), axis=2)
    share = np.concatenate([np.zeros((m, 1)), np.cumsum(steps, axis=1)], axis=1)
    length = share[:, -1]
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
    return _shifted(shown, warp @ sines.T) - means, polynomials


def _shifted(shown: Array, shift: Array) -> Array:
    """Interpolate courses at times that are later by shares (m, n) of the duration."""
    m, n, _ = shown.shape
    at = np.clip((np.linspace(0.0, 1.0, n) + shift) * (n - 1), 0.0, n - 1)
    before = np.minimum(at.astype(int), n - 2)
    part = (at - before)[..., None]
    rows = np.arange(m)[:, None]
    return np.asarray((1 - part) * shown[rows, before] + part * shown[rows, before + 1])
