"""Published ways to predict a path between new ends, for comparison: TP-GMM, DMP, ProMP and simpler ones.

Each takes demonstrations (m, n, 3) [m] at equal arc lengths, a start and a goal (3,) [m], and returns the path (n, 3).
"""

from __future__ import annotations

import warnings

import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.mixture import GaussianMixture

from teachpath.records import Array

COMPONENTS = 3  # of the mixture; of 3, 5 and 8 the best on recorded hands
SPREAD = 1e-3  # added to its covariances; the best of 1e-4 and 1e-3
KERNELS = 20  # of DMP and ProMP
POWER = 0.8  # of the distance, by which shapes grow
STIFFNESS = 100.0  # of the DMP, per square of its duration; critically damped


def straight_line(shown: Array, start: Array, goal: Array) -> Array:
    return np.asarray(start + _share(shown.shape[1]) * (goal - start))


def mean_shape(shown: Array, start: Array, goal: Array) -> Array:
    """The mean of what demonstrations have beside the straight line, in the world."""
    return straight_line(shown, start, goal) + np.mean([_beside(path) for path in shown], axis=0)


def tp_gmm(shown: Array, start: Array, goal: Array) -> Array:
    """Frames at start and goal, turned with the direction between them (Calinon 2016)."""
    return _by_frames(shown, start, goal, power=0.0)


def tp_gmm_scaled(shown: Array, start: Array, goal: Array) -> Array:
    """The same in units of a power of the distance, and with its ends moved to start and goal."""
    return _with_ends(_by_frames(shown, start, goal, power=POWER), start, goal)


def dmp(shown: Array, start: Array, goal: Array) -> Array:
    """Forcing terms per axis and scaled by its distance, the mean of all demonstrations' (Ijspeert et al. 2013)."""
    weights = np.mean([_forcing(path, path[-1] - path[0]) for path in shown], axis=0)
    return _integrated(weights, start, goal, goal - start, shown.shape[1])


def dmp_scaled(shown: Array, start: Array, goal: Array) -> Array:
    """The same in the frame from start to goal and in units of a power of the distance, without a scale per axis."""
    local = []
    for path in shown:
        turn, scale = _frame(path[0], path[-1], POWER)
        local.append((path - path[0]) @ turn / scale)
    turn, scale = _frame(start, goal, POWER)
    weights = np.mean([_forcing(path, np.ones(3)) for path in local], axis=0)
    path = _integrated(weights, np.zeros(3), turn.T @ (goal - start) / scale, np.ones(3), shown.shape[1])
    return np.asarray(start + scale * path @ turn.T)


def promp(shown: Array, start: Array, goal: Array) -> Array:
    """Gaussian weights of kernels, conditioned on both ends (Paraschos et al. 2013)."""
    basis = _kernels(np.linspace(0.0, 1.0, shown.shape[1]))
    solve = np.linalg.solve(basis.T @ basis + 1e-6 * np.eye(KERNELS), basis.T)
    weights = np.array([(solve @ path).T.ravel() for path in shown])
    mean, spread = weights.mean(axis=0), np.cov(weights.T, bias=True) + 1e-4 * np.eye(3 * KERNELS)
    ends = np.vstack([np.kron(np.eye(3), basis[0]), np.kron(np.eye(3), basis[-1])])  # (6, 3 kernels)
    gain = spread @ ends.T @ np.linalg.inv(ends @ spread @ ends.T + 1e-6 * np.eye(6))
    found = mean + gain @ (np.concatenate([start, goal]) - ends @ mean)
    return np.asarray(basis @ found.reshape(3, KERNELS).T)


def _by_frames(shown: Array, start: Array, goal: Array, *, power: float) -> Array:
    count = shown.shape[1]
    u = np.linspace(0.0, 1.0, count)
    rows = []
    for path in shown:
        turn, scale = _frame(path[0], path[-1], power)
        rows.append(np.column_stack([u, (path - path[0]) @ turn / scale, (path - path[-1]) @ turn / scale]))
    slices = np.array(
        [[row[part].mean(axis=0) for part in np.array_split(np.arange(count), COMPONENTS)] for row in rows]
    )
    mixture = GaussianMixture(COMPONENTS, means_init=slices.mean(axis=0), reg_covar=SPREAD, random_state=0, max_iter=50)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        mixture.fit(np.concatenate(rows))
    turn, scale = _frame(start, goal, power)
    to_world = np.eye(4)
    to_world[1:, 1:] = scale * turn
    means, spreads = [], []
    for mean, spread in zip(mixture.means_, mixture.covariances_, strict=True):
        placed = []
        for part, origin in (([0, 1, 2, 3], start), ([0, 4, 5, 6], goal)):
            precision = np.linalg.inv(to_world @ spread[np.ix_(part, part)] @ to_world.T)
            placed.append((precision, precision @ (to_world @ mean[part] + np.append(0.0, origin))))
        spreads.append(np.linalg.inv(placed[0][0] + placed[1][0]))
        means.append(spreads[-1] @ (placed[0][1] + placed[1][1]))
    return _regression(u, mixture.weights_, np.array(means), np.array(spreads))


def _regression(u: Array, weights: Array, means: Array, spreads: Array) -> Array:
    variances = spreads[:, 0, 0]
    off = u[:, None] - means[:, 0]
    likely = weights * np.exp(-(off**2) / variances / 2) / np.sqrt(variances)
    likely /= likely.sum(axis=1, keepdims=True)
    each = means[:, 1:] + off[..., None] * spreads[:, 1:, 0] / variances[:, None]
    return np.asarray((likely[..., None] * each).sum(axis=1))


def _forcing(path: Array, amplitude: Array) -> Array:
    """Return the weights (kernels, 3) of the forcing term of a path that is followed in unit time."""
    u = np.linspace(0.0, 1.0, len(path))
    speed = np.gradient(path, u, axis=0)
    force = np.gradient(speed, u, axis=0) - STIFFNESS * (path[-1] - path) + 2 * np.sqrt(STIFFNESS) * speed
    amplitude = np.where(np.abs(amplitude) < 1e-3, 1e-3, amplitude)
    return np.asarray(np.linalg.lstsq(_kernels(u), force / amplitude, rcond=None)[0])


def _integrated(weights: Array, start: Array, goal: Array, amplitude: Array, count: int) -> Array:
    fine = 20 * (count - 1) + 1
    forces = _kernels(np.linspace(0.0, 1.0, fine)) @ weights * amplitude
    path, speed, step = [start], np.zeros(3), 1.0 / (fine - 1)
    speed = (forces[0] + STIFFNESS * (goal - start)) / (2 * np.sqrt(STIFFNESS))
    for force in forces[:-1]:
        speed = speed + step * (STIFFNESS * (goal - path[-1]) - 2 * np.sqrt(STIFFNESS) * speed + force)
        path.append(path[-1] + step * speed)
    return np.asarray(path[::20])


def _kernels(u: Array) -> Array:
    centres = np.linspace(0.0, 1.0, KERNELS)
    values = np.exp(-((u[:, None] - centres) ** 2) * KERNELS**2 / 2)
    return np.asarray(values / values.sum(axis=1, keepdims=True))


def _frame(start: Array, goal: Array, power: float) -> tuple[Array, Array]:
    """Return the rotation (3, 3) about the vertical towards the goal, and a power of the horizontal distance."""
    x, y, _ = goal - start
    distance = max(float(np.hypot(x, y)), 1e-6)
    cosine, sine = x / distance, y / distance
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]]), np.array(distance**power)


def _with_ends(path: Array, start: Array, goal: Array) -> Array:
    share = _share(len(path))
    return np.asarray(path + (1 - share) * (start - path[0]) + share * (goal - path[-1]))


def _beside(path: Array) -> Array:
    return np.asarray(path - path[0] - _share(len(path)) * (path[-1] - path[0]))


def _share(count: int) -> Array:
    return np.linspace(0.0, 1.0, count)[:, None]
