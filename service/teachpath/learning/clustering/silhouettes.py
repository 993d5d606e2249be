"""Mean silhouettes of all cuts of one dendrogram (Rousseeuw 1987)."""

from __future__ import annotations

import numpy as np

from teachpath.learning.clustering.dendrogram import Labels, labels_for_count
from teachpath.learning.clustering.distances import Distances
from teachpath.learning.settings import Progress, no_progress
from teachpath.records import Array


class Silhouettes:
    """The mean silhouettes of the cuts of one dendrogram into 2 to `most` clusters.

    The sums of the distances from every demonstration to every cluster of the finest cut are kept; the sums of coarser
    cuts follow by addition.

    Args:
        condensed: distances of all pairs, in scipy's order.
        linkage: the dendrogram, m - 1 merges.
        most: clusters, at most m.
        progress: receives the fraction done and a sentence.
    """

    def __init__(self, condensed: Distances, linkage: Array, most: int, progress: Progress = no_progress) -> None:
        self._linkage = linkage
        self._finest = labels_for_count(linkage, most) - 1
        self._sums = distance_sums(condensed, self._finest, most, progress)

    def mean(self, count: int) -> float:
        """Return the mean silhouette of the cut into `count` clusters, -1 to 1."""
        labels, sums = self._cut(count)
        return float(_values(sums, labels).mean())

    def mean_of_split(self, count: int) -> tuple[float, int]:
        """Find the cluster that the cut into `count` + 1 splits, and its mean silhouette as if it were alone.

        Returns:
            the mean silhouette and the number of members.
        """
        coarse, (fine, sums) = self._cut(count)[0], self._cut(count + 1)
        for label in range(count):
            inside = coarse == label
            parts = np.unique(fine[inside])
            if len(parts) > 1:
                return float(_values(sums[np.ix_(inside, parts)], np.searchsorted(parts, fine[inside])).mean()), int(
                    inside.sum()
                )
        raise AssertionError(f"no cluster is split between {count} and {count + 1}")

    def _cut(self, count: int) -> tuple[Labels, Array]:
        labels = labels_for_count(self._linkage, count) - 1
        membership = np.zeros((self._sums.shape[1], count))
        membership[self._finest, labels] = 1.0
        return labels, self._sums @ membership


def distance_sums(condensed: Distances, labels: Labels, count: int, progress: Progress = no_progress) -> Array:
    """Return the sums of the distances from every demonstration to the members of every cluster: (m, count) [m].

    Args:
        condensed: distances of all pairs, in scipy's order.
        labels: (m,) cluster of each demonstration, 0 to `count` - 1.
        count: number of clusters.
        progress: receives the fraction done and a sentence.
    """
    m = len(labels)
    sums = np.zeros((m, count))
    begin = 0
    for i in range(m - 1):
        if i % 64 == 0:
            progress(i / m, "looking for the number of ways")
        row = condensed[begin : begin + m - i - 1]
        sums[i] += np.bincount(labels[i + 1 :], row, count)
        sums[i + 1 :, labels[i]] += row
        begin += m - i - 1
    return sums


def _values(sums: Array, labels: Labels) -> Array:
    """Return the silhouette of every demonstration; a demonstration alone in its cluster counts 0."""
    sizes = np.bincount(labels, minlength=sums.shape[1])
    rows = np.arange(len(labels))
    within = sums[rows, labels] / np.maximum(sizes[labels] - 1, 1)
    means = sums / np.maximum(sizes, 1)
    means[rows, labels] = np.inf
    nearest = means.min(axis=1)
    larger = np.maximum(within, nearest)
    values = np.divide(nearest - within, larger, out=np.zeros(len(labels)), where=larger > 0)
    return np.asarray(np.where(sizes[labels] > 1, values, 0.0))
