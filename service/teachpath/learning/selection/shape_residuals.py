"""Whether a demonstration bends where the others do not: what is left when its pace and its slow drift are taken off.

Demonstrations of one way differ in pace and by slow drifts, which say nothing. Both are smooth: a hand that keeps to
the way is that of the others at times warped by a few sines, beside them by a polynomial of low degree. A detour is
neither, and shows as too much energy in the degrees above.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from teachpath.learning.resampling import at_equal_times
from teachpath.records import Array, Trajectory

COURSE_POINTS = 100  # equal times that a course is known at
WARP_SINES = 3  # of the warp of time
DRIFT_DEGREE = 5  # highest degree that is taken for drift while the pace is compared
WARP_SCALE = 0.01  # share of the length of the way by which a full warp counts as unlikely
GAUSS_NEWTON_STEPS = 4  # of Gauss and Newton's method
MIN_DEGREE, END_DEGREE = 4, 9  # degrees whose energy counts, first to one behind the last
ENERGY_EXPONENT = 8  # power of the degree by which the energy of a smooth hand falls
TRIM_RATIO = 8  # of so many others, the one that bends most does not count
MIN_COURSES = 4  # courses, of which three say what is usual
SURPRISE_ALLOWANCE = 2.2  # surprise [nats] that is nothing unusual
Z_PER_NAT = 10.0  # z for a nat above: with the limit of z, one of twenty clean ones among five is called inconsistent


def courses(trajectories: Sequence[Trajectory], paths: Sequence[Array]) -> list[Array]:
    """Return smoothed paths at equal shares of their durations: for each (100, 3) [m]."""
    return [at_equal_times(t, COURSE_POINTS, path) for t, path in zip(trajectories, paths, strict=True)]


def score_bending(shown: Array) -> tuple[Array, Array]:
    """Compare every course with the mean of the others.

    Args:
        shown: (m, 100, 3) [m].

    Returns:
        (m,) z, 0 or less, by how much its bends are unlike those of the others, 0 for fewer than four; (m, 100)
        log-likelihoods of its instants, but for a constant.
    """
    m = len(shown)
    if m < MIN_COURSES:
        return np.zeros(m), np.zeros((m, COURSE_POINTS))
    means = (shown.sum(axis=0) - shown) / (m - 1)
    apart, polynomials = _apart(shown, means)
    coefficients = polynomials[:, :, MIN_DEGREE:END_DEGREE].transpose(0, 2, 1) @ apart  # (m, degrees, 3)
    energies = np.square(coefficients).sum(axis=2) * np.arange(MIN_DEGREE, END_DEGREE) ** float(ENERGY_EXPONENT)
    usual = _usual(energies.mean(axis=1))
    surprise = np.log1p(energies / (3 * usual[:, None])).sum(axis=1)
    bends = polynomials[:, :, MIN_DEGREE:END_DEGREE] @ coefficients
    spread = np.square(bends).sum(axis=2).mean(axis=1)
    profiles = -0.5 * np.square(bends).sum(axis=2) / np.maximum(_usual(spread), 1e-12)[:, None]
    return -Z_PER_NAT * np.maximum(surprise - SURPRISE_ALLOWANCE, 0.0), profiles


def _usual(energies: Array) -> Array:
    """Return for each the mean of the others, without those that have most: (m,)."""
    m = len(energies)
    others = np.sort(np.broadcast_to(energies, (m, m))[~np.eye(m, dtype=bool)].reshape(m, m - 1), axis=1)
    return np.asarray(others[:, : max(m - 1 - (m - 1) // TRIM_RATIO, 1)].mean(axis=1)) + 1e-12


def _apart(shown: Array, means: Array) -> tuple[Array, Array]:
    """Return how far each course is from its mean at warped times (m, 100, 3) [m], and the polynomials along the mean.

    The polynomials (m, 100, degrees) are orthonormal over the instants, in the share of the way.
    """
    steps = np.linalg.norm(np.diff(means, axis=1), axis=2)
    share = np.concatenate([np.zeros((len(means), 1)), np.cumsum(steps, axis=1)], axis=1)
    length = share[:, -1]
    share /= np.maximum(length, 1e-12)[:, None]
    polynomials = np.linalg.qr(np.polynomial.legendre.legvander(2 * share - 1, END_DEGREE - 1))[0]
    drift, sines = polynomials[:, :, : DRIFT_DEGREE + 1], _sines()
    stiff = COURSE_POINTS * np.square(WARP_SCALE * length)[:, None] + 1e-12
    warp = np.zeros((len(shown), WARP_SINES))
    for _ in range(GAUSS_NEWTON_STEPS):
        course = _at(shown, warp @ sines.T)
        rate = np.gradient(course, axis=1) * (COURSE_POINTS - 1)
        pulls = [rate * sine[:, None] for sine in sines.T]  # of each sine on the course
        free = np.concatenate([course - means, *pulls], axis=2)  # (m, 100, 3 + 3 sines)
        free = (free - drift @ (drift.transpose(0, 2, 1) @ free)).reshape(len(shown), COURSE_POINTS, WARP_SINES + 1, 3)
        flat = free.transpose(0, 2, 1, 3).reshape(len(shown), WARP_SINES + 1, -1)
        products = flat @ flat.transpose(0, 2, 1)
        normal = products[:, 1:, 1:] + stiff[..., None] * np.eye(WARP_SINES)
        warp = warp - np.linalg.solve(normal, (products[:, 1:, 0] + stiff * warp)[..., None])[..., 0]
    return _at(shown, warp @ sines.T) - means, polynomials


@cache
def _sines() -> Array:
    return np.sin(np.pi * np.outer(np.linspace(0.0, 1.0, COURSE_POINTS), np.arange(1, WARP_SINES + 1)))


def _at(shown: Array, later: Array) -> Array:
    """Return courses at times that are later by shares of the duration (m, 100)."""
    at = np.clip((np.linspace(0.0, 1.0, COURSE_POINTS) + later) * (COURSE_POINTS - 1), 0.0, COURSE_POINTS - 1)
    before = np.minimum(at.astype(int), COURSE_POINTS - 2)
    part = (at - before)[..., None]
    rows = np.arange(len(shown))[:, None]
    return np.asarray((1 - part) * shown[rows, before] + part * shown[rows, before + 1])
