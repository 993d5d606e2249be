"""Clustering of very many demonstrations: a random sample is clustered, and each other one joins the nearest of it.

The number of pairs grows with the square of the number of demonstrations, the number of distances to a sample only in
proportion. A cluster may be missed when it has fewer members than one in the size of the sample.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from teachpath.learning.clustering.average_linkage import average_linkage
from teachpath.learning.clustering.dendrogram import Labels, extended_linkage, labels_at_height
from teachpath.learning.clustering.distances import nearest_paths, pairwise_distances
from teachpath.learning.clustering.ends import OF_TASKS, end_groups, grouped_linkage
from teachpath.learning.clustering.incomplete import Stop, find_incomplete
from teachpath.learning.clustering.partial_splits import partial_splits, split_linkage
from teachpath.learning.clustering.partition import Partition, cut_as_set, cut_by_separation, doubting_splits
from teachpath.learning.settings import LearningSettings, Progress, Subprogress, no_progress
from teachpath.records import Array

MAX_EXACT_DEMONSTRATIONS = 20_000  # above which only distances to a sample are measured
SAMPLE_SIZE = 2000
JOINING_SHARE = 0.4  # of the first merge of a complete demonstration, at which an incomplete one joins it; below half


def cluster_paths(
    paths: Array, settings: LearningSettings, *, length: float, metric: str, progress: Progress = no_progress
) -> Partition:
    """Cluster paths, by all pairs or from 20,000 on by a sample of 2000.

    Every path outside the sample belongs to the cluster of its nearest path in the sample. With a threshold set, a path
    farther than the threshold from the whole sample is a cluster by itself.

    Args:
        paths: (m, n, 3) [m].
        settings: see `partition.cut_as_set`; `seed` draws the sample.
        length: of a typical path [m].
        metric: see `distances.pairwise_distances`.
        progress: receives the fraction done and a sentence.
    """
    m = len(paths)
    if m <= MAX_EXACT_DEMONSTRATIONS:
        return _cluster_by_all_pairs(paths, settings, length, metric, progress)
    sample = np.sort(np.random.default_rng(settings.seed).choice(m, SAMPLE_SIZE, replace=False))
    of_sample = _cluster_by_all_pairs(paths[sample], settings, length, metric, no_progress)
    joins, apart = nearest_paths(paths, paths[sample], metric, progress)
    joins, apart = sample[joins], apart.copy()
    joins[sample] = sample
    if settings.threshold is None or settings.clusters is not None:
        apart = np.minimum(apart, of_sample.threshold)
    linkage = extended_linkage(of_sample.linkage, sample, joins, apart)
    labels = labels_at_height(linkage, of_sample.threshold)
    note = f"{m} demonstrations are grouped by a sample of {SAMPLE_SIZE}"
    notes = "; ".join(sentence for sentence in (note, of_sample.note) if sentence)
    incomplete = {
        int(sample[i]): replace(stop, follows=int(sample[stop.follows])) for i, stop in of_sample.incomplete.items()
    }
    return replace(of_sample, linkage=linkage, labels=labels, note=notes, incomplete=incomplete)


def _cluster_by_all_pairs(
    paths: Array, settings: LearningSettings, length: float, metric: str, progress: Progress
) -> Partition:
    if metric == "undersampled":  # whose first and last points are drawn at random
        condensed = pairwise_distances(paths, metric, Subprogress(progress, 0.0, 0.7))
        tree = average_linkage(condensed, len(paths), Subprogress(progress, 0.7, 1.0))
        return cut_as_set(tree, settings, length=length)
    comparing = Subprogress(progress, 0.0, 0.2)
    groups = end_groups(
        paths, min_separation=settings.min_separation, length=length, scatter=OF_TASKS, progress=comparing
    )
    incomplete = find_incomplete(paths, groups, length)
    complete = np.setdiff1d(np.arange(len(paths)), list(incomplete))
    groups = np.unique(groups[complete], return_inverse=True)[1] + 1
    condensed = pairwise_distances(paths[complete], metric, Subprogress(progress, 0.2, 0.7))
    tree = grouped_linkage(condensed, groups, Subprogress(progress, 0.7, 0.9))
    count, separation = int(groups.max()), settings.min_separation
    found = cut_by_separation(tree, min_separation=separation, length=length, groups=count)
    # The dendrogram must not depend on the cut that is set: every cut of a run can be made from the beginning.
    split = partial_splits(paths[complete], found.labels, min_separation=separation, length=length)
    tree = split_linkage(condensed, tree, found.labels, split, Subprogress(progress, 0.9, 1.0))
    if settings.clusters is not None or settings.threshold is not None:
        partition = cut_as_set(tree, settings, length=length, groups=count)
    else:
        partition = doubting_splits(found, tree, int(split.max()))
    return _with_incomplete(partition, complete, incomplete) if incomplete else partition


def _with_incomplete(partition: Partition, complete: Labels, incomplete: Mapping[int, Stop]) -> Partition:
    """Let incomplete demonstrations join the complete ones that they follow, below every other merge of these."""
    first_merges = np.full(len(complete), np.inf)
    for left, right, height, _ in partition.linkage[::-1]:
        for node in (int(left), int(right)):
            if node < len(complete):
                first_merges[node] = height
    joins = np.arange(len(complete) + len(incomplete))
    heights = np.zeros(len(joins))
    for number, stop in incomplete.items():
        joins[number] = stop.follows
        heights[number] = JOINING_SHARE * first_merges[np.searchsorted(complete, stop.follows)]
    linkage = extended_linkage(partition.linkage, complete, joins, heights)
    labels = labels_at_height(linkage, partition.threshold)
    return replace(partition, linkage=linkage, labels=labels, incomplete=incomplete)
