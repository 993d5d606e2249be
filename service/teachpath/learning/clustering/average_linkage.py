"""Average linkage: the dendrogram of demonstrations from the distances of all pairs."""

from __future__ import annotations

import numpy as np
from scipy.cluster import hierarchy

from teachpath.learning.clustering.dendrogram import scipy_linkage
from teachpath.learning.clustering.distances import Distances
from teachpath.learning.settings import Progress, no_progress
from teachpath.records import Array

MAX_SCIPY_DEMONSTRATIONS = 200  # up to which scipy finishes before the compiled kernel would be loaded
MERGES_PER_UPDATE = 64  # between two reports of progress


def average_linkage(condensed: Distances, count: int, progress: Progress = no_progress) -> Array:
    """Merge the two closest clusters, by the mean distance of their members, until one is left.

    Args:
        condensed: distances of all pairs [m], in scipy's order.
        count: number m of demonstrations.
        progress: receives the fraction done and a sentence; what it raises passes through.

    Returns:
        (m - 1, 4) merges as scipy writes them.
    """
    if count == 1:
        return np.empty((0, 4))
    if count <= MAX_SCIPY_DEMONSTRATIONS:
        return np.asarray(hierarchy.linkage(condensed, "average"))
    from teachpath.learning.clustering import kernels

    apart = np.array(condensed, dtype=np.float32)
    merges = np.empty((count - 1, 4))
    sizes, chain, state = np.ones(count, dtype=np.int64), np.zeros(count, dtype=np.int64), np.zeros(2, dtype=np.int64)
    while state[1] < count - 1:
        progress(float(state[1]) / count, "merging the closest demonstrations")
        kernels.merge(apart, sizes, chain, state, merges, MERGES_PER_UPDATE)
    order = np.argsort(merges[:, 2], kind="stable")
    return scipy_linkage([(float(height), int(one), int(other)) for one, other, height, _ in merges[order]], count)
