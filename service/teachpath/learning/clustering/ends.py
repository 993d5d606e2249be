"""Starts and goals of demonstrations: where they differ by more than their scatter, a mean would lead to neither."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import pdist

from teachpath.learning.clustering.average_linkage import MAX_SCIPY_DEMONSTRATIONS, average_linkage
from teachpath.learning.clustering.dendrogram import Labels, labels_for_count
from teachpath.learning.clustering.distances import Distances, pairwise_distances
from teachpath.learning.clustering.partition import separated_clusters, separations
from teachpath.learning.settings import Progress, Subprogress, no_progress
from teachpath.records import Array

MIN_RISE = 1.01  # of the height of a merge between groups to that of the merge before


@dataclass(frozen=True)
class EndScatter:
    """What is known of the ends of demonstrations alike before any is seen.

    Attributes:
        usual: mean distance of the ends of two, as share of the path length; two that were shown alone have different
            ends when these are 0.0425 of the length apart.
        pairs: measured distances for which it counts.
        separation: times the least separation, which different ends need.
    """

    usual: float
    pairs: int
    separation: float


# What a hand usually keeps to: by it, an object has been moved.
OF_HANDS = EndScatter(0.017, 4, 1.0)
# Some tasks begin or end more loosely. Ends scatter to all sides of one place, and some lie far from the others by
# chance: seven that begin within 3 % of the length are parted in 71 % by the scatter of hands, in 22 % by this one.
OF_TASKS = EndScatter(0.01417, 2, 1.25)


def end_groups(
    paths: Array,
    *,
    min_separation: float,
    length: float,
    scatter: EndScatter = OF_HANDS,
    progress: Progress = no_progress,
) -> Labels:
    """Group paths (m, n, 3) [m] that begin and end in the same places, as `partition.cut_by_separation` groups paths.

    Args:
        paths: at equal arc lengths.
        min_separation: least ratio of the distance of two groups to the scatter within them.
        length: of a typical path [m].
        scatter: of ends at one place.
        progress: receives the fraction done and a sentence.

    Returns:
        (m,) labels 1, 2, ... in the order of the first members.
    """
    if len(paths) < 2:
        return np.ones(len(paths), dtype=np.int64)
    distances: Distances
    if len(paths) > MAX_SCIPY_DEMONSTRATIONS:
        # The discrete Fréchet distance of two lines is the larger distance of their ends.
        distances = pairwise_distances(paths[:, [0, -1]], "frechet", Subprogress(progress, 0.0, 0.5))
    else:
        distances = np.maximum(pdist(paths[:, 0]), pdist(paths[:, -1]))
    tree = average_linkage(distances, len(paths), Subprogress(progress, 0.5, 1.0))
    ratios = separations(tree, length, scatter.usual, scatter.pairs) / (scatter.separation * min_separation)
    return labels_for_count(tree, separated_clusters(ratios))


def grouped_linkage(condensed: Distances, groups: Labels, progress: Progress = no_progress) -> Array:
    """Merge by average linkage, the members of every group before any two groups.

    Args:
        condensed: distances of all pairs [m], in scipy's order.
        groups: (m,) labels, see `end_groups`.
        progress: receives the fraction done and a sentence.

    Returns:
        (m - 1, 4) merges as scipy writes them. A merge of two groups that are nearer than the merges within them is
        raised just above these, so that every cut keeps the order.
    """
    count = len(groups)
    between = int(groups.max()) - 1
    if between == 0:
        return average_linkage(condensed, count, progress)
    lift = float(np.max(condensed))  # makes every distance between groups larger than any within
    distances = condensed.copy()
    begin = 0
    for i in range(count - 1):
        end = begin + count - 1 - i
        distances[begin:end][groups[i + 1 :] != groups[i]] += lift
        begin = end
    tree = average_linkage(distances, count, progress)
    for row in range(count - 1 - between, count - 1):
        before = float(tree[row - 1, 2]) if row else 0.0
        tree[row, 2] = max(float(tree[row, 2]) - lift, MIN_RISE * before)
    return tree
