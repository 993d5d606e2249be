"""The different ways of doing a task: hierarchical clustering of demonstrations by the distance of their paths."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.spatial.distance import squareform

from teachpath.learning.settings import Progress, ignore
from teachpath.records import Array

Labels = NDArray[np.int64]

MOST_CLUSTERS = 10  # that the silhouette chooses among
APART = 0.1  # share of the path length: two demonstrations farther apart are two ways
CAUTION = 0.5  # divided by its members, added to the guard of a cluster: few fall apart by chance
CLOSE_CALL = 0.08  # of the silhouette


@dataclass(frozen=True, eq=False)
class Grouping:
    """Demonstrations in clusters.

    Attributes:
        linkage: (m - 1, 4) merges as scipy writes them, heights in metres.
        threshold: height of the cut [m].
        labels: (m,) cluster of each demonstration, 1, 2, ... in the order of their first members.
        note: what is doubtful about it, or empty.
    """

    linkage: Array
    threshold: float
    labels: Labels
    note: str = ""


def distances(paths: Array, progress: Progress = ignore) -> Array:
    """Return the mean distance of corresponding points for every pair (Aleotti & Caselli, eq. (1)).

    Args:
        paths: (m, n, 3) [m].
        progress: is told how far the work has come.

    Returns:
        (m (m - 1) / 2,) [m], condensed in scipy's order.
    """
    m = len(paths)
    rows = [np.empty(0)]
    for i in range(m - 1):
        progress(1 - ((m - i) / m) ** 2, "measuring the distances between demonstrations")
        rows.append(np.sqrt(np.square(paths[i + 1 :] - paths[i]).sum(axis=2)).mean(axis=1))
    return np.concatenate(rows)


def cut_at(condensed: Array, count: int, threshold: float) -> Grouping:
    """Merge by average link until the two closest clusters are farther apart than `threshold` [m]."""
    if count == 1:
        return Grouping(np.empty((0, 4)), threshold, np.ones(1, dtype=np.int64))
    tree = linkage(condensed, "average")
    return Grouping(tree, threshold, _by_first_member(fcluster(tree, threshold, "distance")))


def cut_by_silhouette(condensed: Array, count: int, *, guard: float, length: float) -> Grouping:
    """Merge by average link and cut where the mean silhouette is best (Rousseeuw 1987).

    A silhouette is not defined for one single cluster, so below `guard` the demonstrations count as one way. The
    best cut of all favours coarse ones when some ways are far apart; it is lowered while the cluster that splits
    next, taken alone, would be more than one way too. One demonstration is one way; two are one way when their
    distance is at most a tenth of the path length.

    Args:
        condensed: distances of all pairs [m].
        count: number m of demonstrations.
        guard: least mean silhouette for more than one cluster.
        length: of a typical path [m], the yardstick for two demonstrations and for doubts.
    """
    if count == 1:
        return cut_at(condensed, 1, 0.0)
    tree = linkage(condensed, "average")
    top = float(tree[-1, 2])
    wide = top > APART * length
    if count == 2:
        threshold = top / 2 if wide else top
        return Grouping(tree, threshold, _by_first_member(fcluster(tree, threshold, "distance")), _pair_note(top, wide))
    square = squareform(condensed)
    candidates = range(2, min(MOST_CLUSTERS, count - 1) + 1)
    labelings = {k: fcluster(tree, k, "maxclust") for k in candidates}
    scores = {k: silhouette(square, labels) for k, labels in labelings.items() if len(np.unique(labels)) == k}
    best = max(scores, key=lambda k: scores[k], default=1)
    if best == 1 or scores[best] < guard:
        doubt = _doubt_one(scores.get(best, 0.0), guard, top, wide)
        return Grouping(tree, top, np.ones(count, dtype=np.int64), doubt)
    while best + 1 in scores and _splits_well(square, labelings[best], labelings[best + 1], guard):
        best += 1
    threshold = float(tree[-best, 2] + tree[-best + 1, 2]) / 2
    return Grouping(tree, threshold, _by_first_member(labelings[best]), _doubt_many(scores, best, guard))


def silhouette(square: Array, labels: NDArray[np.int32] | Labels) -> float:
    """Return the mean silhouette of a partition, -1 to 1; a demonstration alone in its cluster counts 0.

    Args:
        square: (m, m) distances.
        labels: (m,) cluster of each.
    """
    members = labels == np.unique(labels)[:, None]  # (k, m)
    sizes = members.sum(axis=1)
    own = members.argmax(axis=0)
    sums = square @ members.T  # (m, k)
    rows = np.arange(len(labels))
    within = sums[rows, own] / np.maximum(sizes[own] - 1, 1)
    means = sums / sizes
    means[rows, own] = np.inf
    nearest = means.min(axis=1)
    larger = np.maximum(within, nearest)
    values = np.divide(nearest - within, larger, out=np.zeros(len(labels)), where=larger > 0)
    return float(np.where(sizes[own] > 1, values, 0.0).mean())


def _splits_well(square: Array, coarse: NDArray[np.int32], fine: NDArray[np.int32], guard: float) -> bool:
    """Tell whether the one cluster of `coarse` that `fine` splits would be split if it were alone."""
    for label in np.unique(coarse):
        inside = np.flatnonzero(coarse == label)
        if len(np.unique(fine[inside])) > 1:
            alone = square[np.ix_(inside, inside)]
            return silhouette(alone, fine[inside]) >= guard + CAUTION / len(inside)
    return False


def _by_first_member(labels: NDArray[np.int32]) -> Labels:
    _, first, inverse = np.unique(labels, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    return np.asarray(rank[inverse] + 1, dtype=np.int64)


def _pair_note(top: float, wide: bool) -> str:
    ways = "two ways" if wide else "one way"
    return f"two demonstrations, {top * 100:.1f} cm apart, are taken for {ways}; set learning.threshold to decide it"


def _doubt_one(score: float, guard: float, top: float, wide: bool) -> str:
    if wide or score > guard - CLOSE_CALL:
        return (
            f"one way, but ambiguous: the demonstrations are up to {top * 100:.1f} cm apart and the best partition "
            f"has silhouette {score:.2f} (guard {guard:.2f}); set learning.threshold to decide it"
        )
    return ""


def _doubt_many(scores: dict[int, float], best: int, guard: float) -> str:
    close = [k for k, score in scores.items() if k != best and score > scores[best] - CLOSE_CALL]
    rivals = ([1] if scores[best] < guard + CLOSE_CALL else []) + sorted(close)
    if not rivals:
        return ""
    others = " or ".join(str(k) for k in rivals)
    return f"{best} ways, but ambiguous: {others} would do nearly as well; set learning.threshold to decide it"
