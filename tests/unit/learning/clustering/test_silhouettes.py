"""The silhouettes of all cuts from one pass over the distances, against the definition."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.cluster.hierarchy import linkage
from scipy.spatial.distance import pdist, squareform

from teachpath.learning.clustering.dendrogram import labels_for_count
from teachpath.learning.clustering.silhouettes import Silhouettes
from teachpath.records import Array


def scattered(seed: int, count: int = 14) -> Array:
    return pdist(np.random.default_rng(seed).normal(size=(count, 2)))


def by_definition(square: Array, labels: Array) -> float:
    values = []
    for i, label in enumerate(labels):
        own = [j for j in range(len(labels)) if labels[j] == label and j != i]
        others = [np.mean(square[i, labels == other]) for other in set(labels) - {label}]
        a = float(np.mean(square[i, own])) if own else 0.0
        values.append((min(others) - a) / max(a, min(others)) if own else 0.0)
    return float(np.mean(values))


@pytest.mark.parametrize("seed", range(3))
def test_every_cut_has_the_silhouette_of_the_definition(seed: int) -> None:
    condensed = scattered(seed)
    tree = linkage(condensed, "average")
    silhouettes = Silhouettes(condensed, tree, 8)
    for count in range(2, 9):
        expected = by_definition(squareform(condensed), labels_for_count(tree, count))
        assert silhouettes.mean(count) == pytest.approx(expected, abs=1e-12)


def test_a_split_is_judged_as_if_its_cluster_were_alone() -> None:
    condensed = scattered(7)
    tree = linkage(condensed, "average")
    coarse, fine = labels_for_count(tree, 3), labels_for_count(tree, 4)
    split = next(label for label in (1, 2, 3) if len(set(fine[coarse == label])) > 1)
    inside = np.flatnonzero(coarse == split)
    value, members = Silhouettes(condensed, tree, 6).mean_of_split(3)
    assert members == len(inside)
    expected = by_definition(squareform(condensed)[np.ix_(inside, inside)], fine[inside])
    assert value == pytest.approx(expected, abs=1e-12)
