"""Distances of two polylines along the best monotone matching of their points."""

from __future__ import annotations

import numpy as np
from scipy.spatial.distance import cdist

from teachpath.records import Array


def frechet_distance(one: Array, other: Array) -> float:
    """Return the discrete Fréchet distance [m] of two polylines (n, 3) of as many points."""
    return float(frechet_distances(cdist(one, other)[None])[0])


def frechet_distances(apart: Array) -> Array:
    """Return the discrete Fréchet distances (pairs,) [m] from tables of distances of points (pairs, n, n) [m]."""
    pairs, n, _ = apart.shape  # computed along the diagonals of the tables
    flat, stride = apart.reshape(pairs, -1), max(n - 1, 1)  # from one to the next of a diagonal
    last, before = np.full((2, pairs, n + 1), np.inf)  # column i + 1 is row i of the table
    before[:, 0] = -np.inf
    for step in range(2 * n - 1):
        first, end = max(0, step - n + 1), min(step, n - 1) + 1
        reached = np.full((pairs, n + 1), np.inf)
        shortest = np.minimum(np.minimum(last[:, first:end], last[:, first + 1 : end + 1]), before[:, first:end])
        diagonal = flat[:, step + first * stride : step + (end - 1) * stride + 1 : stride]
        np.maximum(diagonal, shortest, out=reached[:, first + 1 : end + 1])
        last, before = reached, last
    return np.asarray(last[:, -1])


def time_warping_distances(apart: Array) -> Array:
    """Return the mean distances (pairs,) [m] along the cheapest monotone matchings, from tables (pairs, n, n) [m]."""
    pairs, n, _ = apart.shape
    last, before = np.full((2, pairs, n + 1, 2), np.inf)  # cost and steps; column i + 1 is row i of the table
    before[:, 0] = 0.0
    for step in range(2 * n - 1):
        rows = np.arange(max(0, step - n + 1), min(step, n - 1) + 1)
        best = last[:, rows]
        for other, wins in ((last[:, rows + 1], np.less), (before[:, rows], np.less_equal)):
            best = np.where(wins(other[..., :1], best[..., :1]), other, best)
        reached = np.full((pairs, n + 1, 2), np.inf)
        reached[:, rows + 1, 0] = best[..., 0] + apart[:, rows, step - rows]
        reached[:, rows + 1, 1] = best[..., 1] + 1
        last, before = reached, last
    return np.asarray(last[:, -1, 0] / last[:, -1, 1])
