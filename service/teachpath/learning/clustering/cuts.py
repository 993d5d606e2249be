"""The possible cuts of the dendrogram of a run; no distance has to be measured again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teachpath.errors import UnusableSettings
from teachpath.learning.clustering.dendrogram import height_for_count, labels_for_count, leaf_order, members_by_label
from teachpath.learning.clustering.partition import Partition, cut_at, cut_into
from teachpath.records import Learned

MIN_CUT_HEIGHT = 1e-9  # m, of a cut; 0 is none


@dataclass(frozen=True, slots=True)
class Cut:
    """One possible cut.

    Attributes:
        clusters: their number.
        lowest: least height of a cut that leaves that many [m].
        highest: greatest height of a cut that leaves that many [m]; None: no upper end.
        height: halfway between them [m].
        leaf_ranges: for each cluster, in the order of its number, the begin and end of its members in the dendrogram's
            `leaves`; the end is excluded.
    """

    clusters: int
    lowest: float
    highest: float | None
    height: float
    leaf_ranges: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class Dendrogram:
    """The dendrogram of a run, ready to be drawn.

    Attributes:
        demonstrations: ids in the order of their numbers in `merges`, 0 to m - 1.
        leaves: ids from left to right; no merge crosses another, and the members of every cluster are neighbours.
        merges: left, right, height [m] and number of members, as scipy writes them; merge i has the number m + i.
        threshold: height of the run's own cut [m].
        clusters: number of clusters of the run's own cut.
        cuts: the possible cuts, from one cluster on.
    """

    demonstrations: tuple[str, ...]
    leaves: tuple[str, ...]
    merges: tuple[tuple[int, int, float, int], ...]
    threshold: float
    clusters: int
    cuts: tuple[Cut, ...]


def dendrogram(learned: Learned, most: int) -> Dendrogram:
    """Return the dendrogram of a run with its cuts into 1 to `most` clusters, or as many as there are."""
    linkage, names = learned.linkage, learned.demonstrations
    order = leaf_order(linkage)
    places = np.empty(len(names), dtype=int)
    places[order] = np.arange(len(names))
    cuts = []
    for count in range(1, min(most, len(names)) + 1):
        labels = labels_for_count(linkage, count)
        begins = np.full(count, len(names))
        np.minimum.at(begins, labels - 1, places)
        ends = begins + np.bincount(labels)[1:]
        leaf_ranges = tuple((int(begin), int(end)) for begin, end in zip(begins, ends, strict=True))
        merges = len(names) - count
        lowest = float(linkage[merges - 1, 2]) if merges else 0.0
        highest = float(linkage[merges, 2]) if count > 1 else None
        cuts.append(Cut(count, lowest, highest, height_for_count(linkage, count), leaf_ranges))
    return Dendrogram(
        names,
        tuple(names[i] for i in order),
        tuple((int(left), int(right), float(height), int(size)) for left, right, height, size in linkage),
        learned.threshold,
        len(learned.clusters),
        tuple(cuts),
    )


def recut_members(
    learned: Learned, *, threshold: float | None = None, clusters: int | None = None
) -> tuple[tuple[str, ...], ...]:
    """Return the members of every cluster for another cut of a run's dendrogram.

    Args:
        learned: the run.
        threshold: height of the cut [m], or
        clusters: their number.

    Returns:
        for every cluster its demonstrations in listed order; clusters in the order of their first members.

    Raises:
        UnusableSettings: see `recut_partition`.
    """
    return members_by_label(learned.demonstrations, recut_partition(learned, threshold, clusters).labels)


def recut_partition(learned: Learned, threshold: float | None, clusters: int | None) -> Partition:
    """Return the partition of a run's demonstrations by another cut.

    Raises:
        UnusableSettings: neither or both are given, or the dendrogram does not allow the cut.
    """
    if threshold is not None and clusters is None:
        if not 0 < threshold < float("inf"):
            raise UnusableSettings(
                f"a dendrogram cannot be cut at {threshold:g} m; the threshold is greater than 0 and finite"
            )
        return cut_at(learned.linkage, threshold)
    if clusters is None or threshold is not None:
        raise UnusableSettings("a dendrogram is cut at a threshold or into a number of clusters; give one of the two")
    count = len(learned.demonstrations)
    if not 1 <= clusters <= count:
        raise UnusableSettings(f"{count} demonstrations cannot be cut into {clusters} clusters; give 1 to {count}")
    if learned.mode == "default":
        return cut_into(learned.linkage, clusters)
    grouping = cut_at(learned.linkage, max(height_for_count(learned.linkage, clusters), MIN_CUT_HEIGHT))
    if grouping.labels.max() != clusters:
        raise UnusableSettings(
            f"no height leaves {clusters} clusters, for merges of one height are made together; "
            f"mode {learned.mode} cuts at a height: give another number"
        )
    return grouping
