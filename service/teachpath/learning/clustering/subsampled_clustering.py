"""Clustering of very many demonstrations: a random sample is clustered, every other one joins its nearest there.

The distances of all pairs grow with the square of their number; those to a sample do not. A way that is shown less
often than once in a sample's worth of demonstrations may be missed.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from teachpath.learning.clustering.dendrogram import grafted, labels_at
from teachpath.learning.clustering.distances import distances, nearest_of
from teachpath.learning.clustering.partition import Grouping, group
from teachpath.learning.settings import LearningSettings, Progress, ignore, part
from teachpath.records import Array

MOST_PAIRED = 20_000  # demonstrations above which not every pair is measured
SAMPLE = 2000


def grouped(
    paths: Array, settings: LearningSettings, *, length: float, metric: str, progress: Progress = ignore
) -> Grouping:
    """Cluster paths, by all pairs or from 20,000 on by a sample of 2000.

    With a threshold set, those farther than it from all of the sample stay alone; else the cut is found on the
    sample and everybody belongs to the cluster of its nearest.

    Args:
        paths: (m, n, 3) [m].
        settings: see `clustering.group`; `seed` draws the sample.
        length: of a typical path [m].
        metric: see `distances.distances`.
        progress: is told how far the work has come.
    """
    m = len(paths)
    measure, cut = part(progress, 0.0, 0.7), part(progress, 0.7, 1.0)
    if m <= MOST_PAIRED:
        condensed = distances(paths, metric, measure)
        return group(condensed, m, settings, length=length, progress=cut)
    sample = np.sort(np.random.default_rng(settings.seed).choice(m, SAMPLE, replace=False))
    condensed = distances(paths[sample], metric)
    of_sample = group(condensed, SAMPLE, settings, length=length)
    joins, apart = nearest_of(paths, paths[sample], metric, progress)
    joins, apart = sample[joins], apart.copy()
    joins[sample] = sample
    if settings.threshold is None or settings.clusters is not None:
        apart = np.minimum(apart, of_sample.threshold)
    linkage = grafted(of_sample.linkage, sample, joins, apart)
    labels = labels_at(linkage, of_sample.threshold)
    note = f"{m} demonstrations are grouped by a sample of {SAMPLE}"
    notes = "; ".join(part for part in (note, of_sample.note) if part)
    return replace(of_sample, linkage=linkage, labels=labels, note=notes)
