"""Hierarchical clustering of demonstrations by the distance of their paths, and the choice of where to cut."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teachpath.learning.clustering.average_linkage import average_linkage
from teachpath.learning.clustering.dendrogram import Labels, height_for_count, labels_at_height, labels_for_count
from teachpath.learning.clustering.distances import Distances
from teachpath.learning.clustering.silhouettes import Silhouettes
from teachpath.learning.settings import LearningSettings, Progress, Subprogress, no_progress
from teachpath.records import Array

MAX_CLUSTERS = 10  # among which the silhouette chooses
MIN_PAIR_SEPARATION = 0.1  # share of the path length; two demonstrations farther apart are two clusters
SMALL_CLUSTER_PENALTY = (
    0.5  # divided by the members of a cluster, added to its least silhouette: few members fall apart by chance
)
SILHOUETTE_MARGIN = 0.08  # of the silhouette
AMBIGUOUS_HEIGHT_RATIO = 1.1  # ratio of a merge's height to that of the cut


@dataclass(frozen=True, eq=False)
class Partition:
    """Demonstrations in clusters.

    Attributes:
        linkage: (m - 1, 4) merges as scipy writes them, heights in metres.
        threshold: height of the cut [m].
        labels: (m,) cluster of each demonstration, 1, 2, ... in the order of their first members.
        note: a sentence about what is doubtful, or empty.
        rival: number of clusters of the next best cut when the choice was close, else None.
    """

    linkage: Array
    threshold: float
    labels: Labels
    note: str = ""
    alternative: int | None = None


def cluster_distances(
    condensed: Distances, count: int, settings: LearningSettings, *, length: float, progress: Progress = no_progress
) -> Partition:
    """Merge by average link and cut as the settings say: at a height, into a number, or where the silhouette is best.

    Args:
        condensed: distances of all pairs [m], in scipy's order.
        count: number m of demonstrations.
        settings: `clusters`, else `threshold`, else `min_silhouette` decide.
        length: of a typical path [m].
        progress: receives the fraction done and a sentence.
    """
    if settings.clusters is not None and settings.mode == "default":
        return cut_into(average_linkage(condensed, count, progress), settings.clusters)
    if settings.threshold is not None:
        return cut_at(average_linkage(condensed, count, progress), settings.threshold)
    return cut_by_silhouette(condensed, count, min_silhouette=settings.min_silhouette, length=length, progress=progress)


def cut_at(tree: Array, threshold: float) -> Partition:
    """Make the merges up to `threshold` [m]: clusters farther apart stay apart."""
    labels = labels_at_height(tree, threshold)
    rival = _next_merge(tree, int(labels.max()), threshold)
    if rival is None:
        return Partition(tree, threshold, labels)
    least = float(tree[1 - max(rival, int(labels.max())), 2])
    note = (
        f"{_ways(int(labels.max()))}, but ambiguous: two clusters {least * 100:.1f} cm apart are close to "
        f"learning.threshold {threshold * 100:.1f} cm, on its other side there are {rival}"
    )
    return Partition(tree, threshold, labels, note, rival)


def cut_into(tree: Array, clusters: int) -> Partition:
    """Make merges until `clusters` are left, or none, every demonstration alone, when there are fewer."""
    count = len(tree) + 1
    left = min(clusters, count)
    height = height_for_count(tree, left)
    note = f"{count} demonstrations cannot be {clusters} ways; every one is its own" if left < clusters else ""
    return Partition(tree, height, labels_for_count(tree, left), note, _next_merge(tree, left, height))


def cut_by_silhouette(
    condensed: Distances, count: int, *, min_silhouette: float, length: float, progress: Progress = no_progress
) -> Partition:
    """Merge by average link and cut where the mean silhouette is best (Rousseeuw 1987).

    A silhouette is not defined for a single cluster, so below `min_silhouette` all demonstrations form one cluster.
    When some clusters lie far apart, the best mean silhouette favours too few clusters; so the cut is lowered while
    the cluster that splits next would be more than one cluster by itself. Two demonstrations form one cluster when
    their distance is at most a tenth of the path length.

    Args:
        condensed: distances of all pairs [m].
        count: number m of demonstrations.
        min_silhouette: least mean silhouette for more than one cluster.
        length: of a typical path [m], to which the distance of two demonstrations is compared.
        progress: receives the fraction done and a sentence.
    """
    if count == 1:
        return cut_into(np.empty((0, 4)), 1)
    tree = average_linkage(condensed, count, Subprogress(progress, 0.0, 0.6))
    top = float(tree[-1, 2])
    wide = top > MIN_PAIR_SEPARATION * length
    if count == 2:
        threshold = top / 2 if wide else top
        return Partition(tree, threshold, labels_at_height(tree, threshold), _pair_note(top, wide), 1 if wide else 2)
    most = min(MAX_CLUSTERS, count - 1)
    silhouettes = Silhouettes(condensed, tree, most, Subprogress(progress, 0.6, 1.0))
    scores = {k: silhouettes.mean(k) for k in range(2, most + 1)}
    best = max(scores, key=lambda k: scores[k])
    if scores[best] < min_silhouette:
        doubt = _doubt_one(scores[best], min_silhouette, top, wide)
        return Partition(tree, top, labels_for_count(tree, 1), doubt, best if doubt else None)
    while best < most:
        alone, members = silhouettes.mean_of_split(best)
        if alone < min_silhouette + SMALL_CLUSTER_PENALTY / members:
            break
        best += 1
    rivals = _rivals(scores, best, min_silhouette)
    note, rival = _doubt_many(best, rivals), rivals[0] if rivals else None
    return Partition(tree, height_for_count(tree, best), labels_for_count(tree, best), note, rival)


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


def _rivals(scores: dict[int, float], best: int, min_silhouette: float) -> list[int]:
    """Return the numbers of clusters with nearly the best silhouette, the best of them first."""
    close = [k for k, score in scores.items() if k != best and score > scores[best] - SILHOUETTE_MARGIN]
    close.sort(key=lambda k: -scores[k])
    return close + ([1] if scores[best] < min_silhouette + SILHOUETTE_MARGIN else [])


def _ways(count: int) -> str:
    return "one way" if count == 1 else f"{count} ways"


def _pair_note(top: float, wide: bool) -> str:
    ways = "two ways" if wide else "one way"
    return f"two demonstrations, {top * 100:.1f} cm apart, are taken for {ways}; set learning.threshold to decide it"


def _doubt_one(score: float, min_silhouette: float, top: float, wide: bool) -> str:
    if wide or score > min_silhouette - SILHOUETTE_MARGIN:
        return (
            f"one way, but ambiguous: the demonstrations are up to {top * 100:.1f} cm apart and the best partition "
            f"has silhouette {score:.2f} (learning.min_silhouette {min_silhouette:.2f}); set learning.threshold to "
            "decide it"
        )
    return ""


def _doubt_many(best: int, rivals: list[int]) -> str:
    if not rivals:
        return ""
    others = " or ".join(str(k) for k in sorted(rivals))
    return f"{best} ways, but ambiguous: {others} would do nearly as well; set learning.threshold to decide it"
