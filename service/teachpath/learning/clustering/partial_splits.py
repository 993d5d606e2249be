"""Ways that differ in a part of the path only: over the whole path their distance is lost in the scatter of the hand.

The slow drifts of a hand lie in the low Legendre degrees over the path; a bump over a third of it reaches the degrees
above, in which demonstrations of one way hardly differ.
"""

from __future__ import annotations

import numpy as np
from scipy.cluster.hierarchy import average
from scipy.spatial.distance import pdist

from teachpath.learning.clustering.dendrogram import Labels, labels_for_count
from teachpath.learning.clustering.distances import Distances
from teachpath.learning.clustering.ends import grouped_linkage
from teachpath.learning.clustering.partition import separations
from teachpath.learning.settings import Progress, no_progress
from teachpath.records import Array

FIRST_DEGREE, END_DEGREE = 5, 13  # that are compared, first to one behind the last
DEGREE_EXPONENT = 3  # power of the degree by which the scatter of a smooth hand falls
USUAL_SCATTER = 0.008  # mean distance in these degrees of two of one way, as share of the path length
MIN_GROUP = 2  # demonstrations that agree; one alone is judged by selection
MAX_MEMBERS = 200  # of a cluster that is looked at


def partial_splits(paths: Array, labels: Labels, *, min_separation: float, length: float) -> Labels:
    """Split every cluster whose members form two groups that differ in a part of the path.

    Args:
        paths: (m, n, 3) [m] at equal arc length.
        labels: (m,) cluster of each.
        min_separation: least ratio of the distance of the groups to the scatter within them.
        length: of a typical path [m].

    Returns:
        (m,) labels 1, 2, ... of the clusters and of the groups of those that are split.
    """
    split = np.zeros_like(labels)
    for label in range(1, int(labels.max()) + 1):
        members = np.flatnonzero(labels == label)
        if 2 * MIN_GROUP <= len(members) <= MAX_MEMBERS:
            split[members] = _groups(paths[members], min_separation, length)
    return np.asarray(np.unique(2 * labels + split, return_inverse=True)[1] + 1)


def split_linkage(
    condensed: Distances, tree: Array, labels: Labels, split: Labels, progress: Progress = no_progress
) -> Array:
    """Return the dendrogram in which every cluster's groups are its last merge, or `tree` where no such one is.

    Args:
        condensed: distances of all pairs [m], in scipy's order.
        tree: (m - 1, 4) merges as scipy writes them.
        labels: (m,) of the clusters that a cut leaves.
        split: (m,) see `partial_splits`.
        progress: receives the fraction done and a sentence.
    """
    if split.max() == labels.max():
        return tree
    found = grouped_linkage(condensed, split, progress)
    return found if np.array_equal(labels_for_count(found, int(labels.max())), labels) else tree


def _groups(paths: Array, min_separation: float, length: float) -> Labels:
    """Return 0 or 1 for each path, all 0 where the paths are one group."""
    count = paths.shape[1]
    degrees = np.arange(FIRST_DEGREE, END_DEGREE)
    polynomials = np.linalg.qr(np.polynomial.legendre.legvander(np.linspace(-1, 1, count), END_DEGREE - 1))[0]
    apart = (paths - paths.mean(axis=0)) / length
    coefficients = np.einsum("nk,mnd->mkd", polynomials[:, FIRST_DEGREE:] / np.sqrt(count), apart)
    weighted = coefficients * ((degrees / FIRST_DEGREE) ** DEGREE_EXPONENT)[:, None]
    tree = average(pdist(weighted.reshape(len(paths), -1)))
    groups = labels_for_count(tree, 2) - 1
    size = int(groups.sum())
    separated = separations(tree, 1.0, USUAL_SCATTER)[-1] >= min_separation
    return groups if separated and min(size, len(paths) - size) >= MIN_GROUP else np.zeros_like(groups)
