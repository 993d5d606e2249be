"""Distances between the paths of demonstrations, for clustering."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from teachpath.learning.matching import frechet_distances, time_warping_distances
from teachpath.learning.settings import Progress, no_progress
from teachpath.records import Array

Distances = NDArray[np.float64] | NDArray[np.float32]  # of all pairs [m], condensed in scipy's order

METRIC_CODES = {"arc": 0, "undersampled": 0, "frechet": 1, "dtw": 2}
MAX_NUMPY_PATHS = (200, 24, 24)  # of each metric code; numpy finishes so many before the kernels would be loaded
PATHS_PER_UPDATE = 1024  # that are assigned between two reports of progress
PAIRS_PER_BATCH = 128  # that are warped together
PROGRESS_MESSAGE = "measuring the distances between demonstrations"


def pairwise_distances(paths: Array, metric: str = "arc", progress: Progress = no_progress) -> Distances:
    """Return the distance of every pair of paths.

    Metric `arc` or `undersampled` is the mean distance of corresponding points (Aleotti & Caselli, eq. (1)),
    `frechet` the discrete Fréchet distance (Eiter & Mannila 1994), `dtw` the mean distance along the best monotone
    matching (Sakoe & Chiba 1978). Large sets are measured in single precision.

    Args:
        paths: (m, n, 3) [m].
        metric: one of the four.
        progress: receives the fraction done and a sentence; what it raises passes through.

    Returns:
        (m (m - 1) / 2,) [m], condensed in scipy's order, those of large sets in single precision.
    """
    kind = METRIC_CODES[metric]
    if len(paths) > MAX_NUMPY_PATHS[kind]:
        return _compiled(paths, kind, progress)
    return _mean(paths, progress) if kind == 0 else _warped(paths, kind, progress)


def nearest_paths(
    paths: Array, chosen: Array, metric: str, progress: Progress = no_progress
) -> tuple[NDArray[np.int64], Array]:
    """Return for every path the number of the nearest chosen one and its distance [m]."""
    from teachpath.learning.clustering import kernels

    centre = paths.mean(axis=(0, 1))
    ours, theirs = _single(paths, centre), _single(chosen, centre)
    found = []
    for begin in range(0, len(paths), PATHS_PER_UPDATE):
        progress(begin / len(paths), "assigning the others to the nearest of the sample")
        found.append(kernels.nearest_paths(ours[begin : begin + PATHS_PER_UPDATE], theirs, METRIC_CODES[metric]))
    return np.concatenate([index for index, _ in found]), np.concatenate([apart for _, apart in found])


def _compiled(paths: Array, kind: int, progress: Progress) -> Distances:
    from teachpath.learning.clustering import kernels

    m = len(paths)
    single = _single(paths, paths.mean(axis=(0, 1)))
    blocks = kernels.blocks_of(single)
    out = np.empty(m * (m - 1) // 2, dtype=np.float32)
    for begin in range(0, m, kernels.PATHS_PER_BLOCK):
        progress(1 - ((m - begin) / m) ** 2, PROGRESS_MESSAGE)
        kernels.fill_rows(single, blocks, out, begin, kind)
    return out


def _single(paths: Array, centre: Array) -> NDArray[np.float32]:
    # Without the common centre, single precision serves the differences between paths, not their place in the world.
    return np.ascontiguousarray((paths - centre).transpose(0, 2, 1), dtype=np.float32)


def _mean(paths: Array, progress: Progress) -> Array:
    m = len(paths)
    rows = [np.empty(0)]
    for i in range(m - 1):
        progress(1 - ((m - i) / m) ** 2, PROGRESS_MESSAGE)
        rows.append(np.sqrt(np.square(paths[i + 1 :] - paths[i]).sum(axis=2)).mean(axis=1))
    return np.concatenate(rows)


def _warped(paths: Array, kind: int, progress: Progress) -> Array:
    left, right = np.triu_indices(len(paths), 1)
    found = [np.empty(0)]
    for begin in range(0, len(left), PAIRS_PER_BATCH):
        progress(begin / len(left), PROGRESS_MESSAGE)
        pairs = slice(begin, begin + PAIRS_PER_BATCH)
        apart = np.stack([cdist(paths[i], paths[j]) for i, j in zip(left[pairs], right[pairs], strict=True)])
        found.append(frechet_distances(apart) if kind == 1 else time_warping_distances(apart))
    return np.concatenate(found)
