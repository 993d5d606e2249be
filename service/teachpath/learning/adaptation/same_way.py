"""Demonstrations that do a task in the same way, wherever their starts and goals are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.distance import pdist

from teachpath.learning.adaptation.kriged_shapes import KrigedShapes
from teachpath.learning.clustering.average_linkage import average_linkage
from teachpath.learning.clustering.dendrogram import Labels, labels_for_count
from teachpath.learning.clustering.distances import pairwise_distances
from teachpath.learning.clustering.ends import end_groups
from teachpath.learning.clustering.partition import separated_clusters, separations
from teachpath.learning.resampling import arc_lengths
from teachpath.lengths import describe_length
from teachpath.records import Array

USUAL_SHAPE_SCATTER = 0.07  # mean distance of two shapes of one way between different ends, as share of the path length


def labels_of_ways(courses: Array, start: Array, goal: Array, *, min_separation: float) -> Labels:
    """Group courses (m, n, 3) [m] by the way that they take once each is brought to the same start and goal (3,) [m].

    Returns:
        (m,) labels 1, 2, ... in the order of the first members.
    """
    if len(courses) < 2:
        return np.ones(len(courses), dtype=np.int64)
    brought = np.array([KrigedShapes(course[None]).predict(start, goal).path for course in courses])
    tree = average_linkage(pairwise_distances(brought, "arc"), len(brought))
    length = float(np.median([arc_lengths(course)[-1] for course in brought]))
    ratios = separations(tree, length, USUAL_SHAPE_SCATTER) / min_separation
    return labels_for_count(tree, separated_clusters(ratios))


def moving_ends(courses: Array, *, min_separation: float) -> list[str]:
    """Say, a sentence a way, which clusters do the task in the same way between different starts or goals.

    Args:
        courses: (k, n, 3) [m] the most central demonstration of each cluster, at equal arc lengths.
        min_separation: least ratio of the distance of two ways to the scatter within them.
    """
    starts, goals = courses[:, 0], courses[:, -1]
    length = float(np.median([arc_lengths(course)[-1] for course in courses]))
    places = end_groups(courses, min_separation=min_separation, length=length)
    if places.max() == 1:
        return []
    ways = labels_of_ways(courses, starts.mean(axis=0), goals.mean(axis=0), min_separation=min_separation)
    alike = [np.flatnonzero(ways == way) for way in np.unique(ways)]
    return [
        _sentence((members + 1).tolist(), _extent(starts[members]), _extent(goals[members]))
        for members in alike
        if len(np.unique(places[members])) > 1
    ]


def _extent(places: Array) -> float:
    """Return the largest distance [m] between two places (m, 3)."""
    return float(pdist(places).max())


def _sentence(clusters: Sequence[int], starts: float, goals: float) -> str:
    *first, last = map(str, clusters)
    return (
        f"clusters {', '.join(first)} and {last} do the task in the same way, from starts up to "
        f"{describe_length(starts)} and to goals up to {describe_length(goals)} apart; adapt one of their paths to "
        "take it anywhere else"
    )
