"""Clustering of very many demonstrations: a random sample is clustered, and each other one joins the nearest of it.

The number of pairs grows with the square of the number of demonstrations, the number of distances to a sample only in
proportion. A cluster may be missed when it has fewer members than one in the size of the sample.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from teachpath.learning.clustering.dendrogram import extended_linkage, labels_at_height
from teachpath.learning.clustering.distances import nearest_paths, pairwise_distances
from teachpath.learning.clustering.partition import Partition, cluster_distances
from teachpath.learning.settings import LearningSettings, Progress, Subprogress, no_progress
from teachpath.records import Array

MAX_EXACT_DEMONSTRATIONS = 20_000  # above which only distances to a sample are measured
SAMPLE_SIZE = 2000


def cluster_paths(
    paths: Array, settings: LearningSettings, *, length: float, metric: str, progress: Progress = no_progress
) -> Partition:
    """Cluster paths, by all pairs or from 20,000 on by a sample of 2000.

    Every path outside the sample belongs to the cluster of its nearest path in the sample. With a threshold set, a path
    farther than the threshold from the whole sample is a cluster by itself.

    Args:
        paths: (m, n, 3) [m].
        settings: see `clustering.cluster_distances`; `seed` draws the sample.
        length: of a typical path [m].
        metric: see `distances.pairwise_distances`.
        progress: receives the fraction done and a sentence.
    """
    m = len(paths)
    measure, cut = Subprogress(progress, 0.0, 0.7), Subprogress(progress, 0.7, 1.0)
    if m <= MAX_EXACT_DEMONSTRATIONS:
        condensed = pairwise_distances(paths, metric, measure)
        return cluster_distances(condensed, m, settings, length=length, progress=cut)
    sample = np.sort(np.random.default_rng(settings.seed).choice(m, SAMPLE_SIZE, replace=False))
    condensed = pairwise_distances(paths[sample], metric)
    of_sample = cluster_distances(condensed, SAMPLE_SIZE, settings, length=length)
    joins, apart = nearest_paths(paths, paths[sample], metric, progress)
    joins, apart = sample[joins], apart.copy()
    joins[sample] = sample
    if settings.threshold is None or settings.clusters is not None:
        apart = np.minimum(apart, of_sample.threshold)
    linkage = extended_linkage(of_sample.linkage, sample, joins, apart)
    labels = labels_at_height(linkage, of_sample.threshold)
    note = f"{m} demonstrations are grouped by a sample of {SAMPLE_SIZE}"
    notes = "; ".join(sentence for sentence in (note, of_sample.note) if sentence)
    return replace(of_sample, linkage=linkage, labels=labels, note=notes)
