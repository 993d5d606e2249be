"""Ways that differ in a part of the path: doubted with the right next cut, and not where there is only one way."""

from __future__ import annotations

import numpy as np
import pytest

from teachpath.learning.clustering.dendrogram import labels_for_count
from teachpath.learning.clustering.partial_splits import partial_splits
from teachpath.learning.clustering.partition import Partition
from teachpath.learning.clustering.subsampled_clustering import cluster_paths
from teachpath.learning.learn import comparable_paths
from teachpath.learning.settings import LearningSettings
from teachpath.records import Array, Trajectory
from tests.experiments.clustering_cases import (
    TIDY_SPREADS,
    Labelled,
    differ_in_part,
    known_ways,
    one_way,
    two_agree_exactly,
)


def paths_of(shown: list[Trajectory]) -> tuple[Array, float]:
    return comparable_paths({str(i): each for i, each in enumerate(shown)}, "arc", 1)


def clustered(shown: list[Trajectory], settings: LearningSettings | None = None) -> Partition:
    paths, length = paths_of(shown)
    return cluster_paths(paths, settings or LearningSettings(), length=length, metric="arc")


def groups(labels: Array) -> set[frozenset[int]]:
    return {frozenset(np.flatnonzero(labels == label).tolist()) for label in np.unique(labels)}


@pytest.mark.parametrize(
    ("shown", "truth"),
    [differ_in_part(seed, (3, 3), 0.06) for seed in range(3)] + [differ_in_part(4, (3, 2), 0.03, **TIDY_SPREADS)],
)
def test_a_bump_over_a_third_of_the_path_is_doubted_and_the_next_cut(shown: list[Trajectory], truth: list[int]) -> None:
    found = clustered(shown)
    assert found.labels.max() == 1
    assert "in a part of the path" in found.note
    assert found.alternative == 2
    assert groups(labels_for_count(found.linkage, 2)) == groups(np.array(truth))


def test_the_next_cut_is_the_one_that_learning_makes_from_the_beginning() -> None:
    shown, truth = differ_in_part(1, (3, 3), 0.06)
    assert groups(clustered(shown, LearningSettings(clusters=2)).labels) == groups(np.array(truth))


def test_one_way_is_seldom_doubted() -> None:
    doubted = ["in a part" in clustered(one_way(seed, 6)[0]).note for seed in range(20)]
    assert sum(doubted) <= 3


def test_only_the_cluster_that_differs_is_split() -> None:
    shown, truth = known_ways(3, (3, 3))
    bumped, of_bump = differ_in_part(3, (3, 3), 0.06)
    paths, length = paths_of([*shown, *bumped])
    labels = np.array([way + 1 for way in truth] + [3] * 6)
    split = partial_splits(paths, labels, min_separation=2.0, length=length)
    assert groups(split) == groups(np.array([*truth, *(2 + way for way in of_bump)]))


@pytest.mark.parametrize("case", [two_agree_exactly(seed) for seed in range(6)])
def test_two_that_agree_exactly_make_no_two_ways_of_two_others(case: Labelled) -> None:
    shown, truth = case
    assert groups(clustered(shown).labels) == groups(np.array(truth))
