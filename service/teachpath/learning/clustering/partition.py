"""Hierarchical clustering of demonstrations by the distance of their paths, and the choice of where to cut."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from teachpath.learning.clustering.dendrogram import Labels, height_for_count, labels_at_height, labels_for_count
from teachpath.learning.clustering.incomplete import Stop
from teachpath.learning.settings import LearningSettings
from teachpath.lengths import describe_length, describe_lengths
from teachpath.records import Array

USUAL_SCATTER = 0.03  # mean distance of two demonstrations of one cluster, as share of the path length
USUAL_SCATTER_PAIRS = 4  # measured distances for which the usual scatter counts
SMALL_CLUSTER_MARGIN = 0.5  # added to the least separation of a cluster of one member, half of it for two, and so on
# A separation within this ratio of the least one is ambiguous. A ratio of 1.25 told of no further wrong cut
# (`python -m tests.experiments.clustering`), but called one of five right ways of an untidy hand ambiguous.
AMBIGUITY_RATIO = 1.1
AMBIGUOUS_HEIGHT_RATIO = 1.1  # of the height of a merge to that of a given cut


@dataclass(frozen=True, eq=False)
class Partition:
    """Demonstrations in clusters.

    Attributes:
        linkage: (m - 1, 4) merges as scipy writes them, heights in metres.
        threshold: height of the cut [m].
        labels: (m,) cluster of each demonstration, 1, 2, ... in the order of their first members.
        note: a sentence about what is doubtful, or empty.
        alternative: number of clusters of the next best cut when the choice was close, else None.
        incomplete: where demonstrations stop that do not reach the goal, by their number.
    """

    linkage: Array
    threshold: float
    labels: Labels
    note: str = ""
    alternative: int | None = None
    incomplete: Mapping[int, Stop] = field(default_factory=dict)


def cut_as_set(
    tree: Array,
    settings: LearningSettings,
    *,
    length: float,
    groups: int = 1,
    usual_scatter: float = USUAL_SCATTER,
) -> Partition:
    """Cut a dendrogram as the settings say: into a number of clusters, at a height, or where clusters separate.

    Args:
        tree: (m - 1, 4) merges as scipy writes them.
        settings: `clusters`, else `threshold`, else `min_separation` decide.
        length: of a typical path [m].
        groups: number of groups of demonstrations with different ends, whose merges come last.
        usual_scatter: mean distance of two demonstrations of one cluster, as share of the length.
    """
    if settings.clusters is not None and settings.mode == "default":
        return cut_into(tree, settings.clusters)
    if settings.threshold is not None:
        return cut_at(tree, settings.threshold)
    return cut_by_separation(
        tree, min_separation=settings.min_separation, length=length, groups=groups, usual_scatter=usual_scatter
    )


def cut_at(tree: Array, threshold: float) -> Partition:
    """Make the merges up to `threshold` [m]: clusters farther apart stay apart."""
    labels = labels_at_height(tree, threshold)
    alternative = _next_merge(tree, int(labels.max()), threshold)
    if alternative is None:
        return Partition(tree, threshold, labels)
    least = float(tree[1 - max(alternative, int(labels.max())), 2])
    apart, limit = describe_lengths(least, threshold)
    note = (
        f"{_ways(int(labels.max()))}, but ambiguous: two clusters {apart} apart are close to "
        f"learning.threshold {limit}, on its other side there are {alternative}"
    )
    return Partition(tree, threshold, labels, note, alternative)


def cut_into(tree: Array, clusters: int) -> Partition:
    """Make merges until `clusters` are left, or none, every demonstration alone, when there are fewer."""
    count = len(tree) + 1
    left = min(clusters, count)
    height = height_for_count(tree, left)
    note = f"{count} demonstrations cannot be {clusters} ways; every one is its own" if left < clusters else ""
    return Partition(tree, height, labels_for_count(tree, left), note, _next_merge(tree, left, height))


def cut_by_separation(
    tree: Array,
    *,
    min_separation: float,
    length: float,
    groups: int = 1,
    usual_scatter: float = USUAL_SCATTER,
) -> Partition:
    """Cut below the lowest merge of two clusters that are separated.

    Two clusters are separated when their distance is at least `min_separation` times the scatter within clusters; a
    cluster of few members needs a little more, because single demonstrations lie apart by chance. The scatter is the
    mean distance of two demonstrations of one cluster, over all clusters that the merges below have made. Few such
    distances say little, so the usual scatter of a hand counts beside them: demonstrations that were shown once are
    clusters when they are about 0.075 of the path length apart. Groups with different ends are always separated.

    Args:
        tree: (m - 1, 4) merges as scipy writes them.
        min_separation: least ratio of the distance of two clusters to the scatter within clusters.
        length: of a typical path [m].
        groups: number of groups of demonstrations with different ends, whose merges come last.
        usual_scatter: mean distance of two demonstrations of one cluster, as share of the length.
    """
    count = len(tree) + 1
    ratios = separations(tree, length, usual_scatter) / min_separation
    ratios[count - groups :] = np.inf
    clusters = separated_clusters(ratios)
    if groups > 1:
        alternative = _close_choice(ratios, clusters)
        note = "; ".join([_ends_note(groups), *([_doubt(clusters, alternative)] if alternative else [])])
    elif count == 2:
        note, alternative = _pair_note(float(tree[0, 2]), clusters), 3 - clusters
    else:
        alternative = _close_choice(ratios, clusters)
        note = _doubt(clusters, alternative) if alternative else ""
    return Partition(
        tree, height_for_count(tree, clusters), labels_for_count(tree, clusters), note, alternative or None
    )


def doubting_splits(found: Partition, tree: Array, groups: int) -> Partition:
    """Return a partition with its dendrogram, whose next cut into `groups` splits clusters in a part of the path."""
    clusters = int(found.labels.max())
    if groups == clusters:
        return found
    note = (
        f"{_ways(clusters)}, but ambiguous: in a part of the path some run beside the others, so that {_ways(groups)} "
        "would do as well; set learning.clusters to decide it"
    )
    notes = "; ".join(sentence for sentence in (found.note, note) if sentence)
    return Partition(tree, height_for_count(tree, clusters), found.labels, notes, groups)


def separated_clusters(ratios: Array) -> int:
    """Return the number of clusters below the lowest merge (m - 1,) whose ratio to the least separation is 1."""
    separated = np.flatnonzero(ratios >= 1)
    return len(ratios) + 1 - int(separated[0]) if len(separated) else 1


def separations(
    tree: Array, length: float, usual_scatter: float = USUAL_SCATTER, usual_pairs: int = USUAL_SCATTER_PAIRS
) -> Array:
    """Return for every merge the distance of its two clusters in units of the scatter within clusters: (m - 1,).

    The ratio of a merge with a small cluster is lowered by the margin that such a cluster needs.

    Args:
        tree: (m - 1, 4) merges as scipy writes them.
        length: of a typical path [m].
        usual_scatter: mean distance of two demonstrations of one cluster, as share of the length.
        usual_pairs: measured distances for which it counts.
    """
    count = len(tree) + 1
    sizes = np.concatenate([np.ones(count), tree[:, 3]])
    merged = sizes[tree[:, :2].astype(int)]
    pairs = merged.prod(axis=1)  # whose mean distance is the height of the merge
    within = np.cumsum(pairs) - pairs
    distances = np.cumsum(pairs * tree[:, 2]) - pairs * tree[:, 2]
    scatter = (usual_pairs * usual_scatter * length + distances) / (usual_pairs + within)
    return np.asarray(tree[:, 2] / scatter - SMALL_CLUSTER_MARGIN / merged.min(axis=1))


def _close_choice(ratios: Array, clusters: int) -> int:
    """Return the number of clusters of the cut that was nearly chosen instead, or 0."""
    count = len(ratios) + 1
    chosen = count - clusters  # row of the merge above the cut
    found = [(float(ratio), count - row) for row, ratio in enumerate(ratios[:chosen]) if ratio * AMBIGUITY_RATIO >= 1]
    if clusters > 1 and ratios[chosen] <= AMBIGUITY_RATIO:
        higher = np.flatnonzero(ratios[chosen + 1 :] >= 1)
        coarser = count - (chosen + 1 + int(higher[0])) if len(higher) else 1
        found.append((1 / float(ratios[chosen]), coarser))
    return max(found, default=(0.0, 0))[1]


def _next_merge(tree: Array, clusters: int, height: float) -> int | None:
    """Return the number of clusters on the other side of the merge nearest to the cut, if that merge is close."""
    near: list[tuple[float, int]] = []
    if not height > 0:
        return None
    if clusters > 1:
        near.append((float(tree[-clusters + 1, 2]) / height, clusters - 1))
    if clusters <= len(tree) and tree[-clusters, 2] > 0:
        near.append((height / float(tree[-clusters, 2]), clusters + 1))
    ratio, other = min(near, default=(np.inf, 0))
    return other if ratio < AMBIGUOUS_HEIGHT_RATIO else None


def _ways(count: int) -> str:
    return "one way" if count == 1 else f"{count} ways"


def _pair_note(distance: float, clusters: int) -> str:
    ways = "two ways" if clusters == 2 else "one way"
    apart = f"{describe_length(distance)} apart"
    return f"two demonstrations, {apart}, are taken for {ways}; set learning.threshold to decide it"


def _ends_note(groups: int) -> str:
    return f"starts or goals differ by more than their scatter: {groups} groups, which are never averaged"


def _doubt(clusters: int, alternative: int) -> str:
    return (
        f"{_ways(clusters)}, but ambiguous: {_ways(alternative)} would do nearly as well; set learning.threshold to "
        "decide it"
    )
