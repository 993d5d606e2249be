"""Very many demonstrations are grouped by a sample, all of them in one dendrogram."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.cluster.hierarchy import is_valid_linkage

from teachpath.errors import Cancelled
from teachpath.learning.clustering.dendrogram import labels_at_height
from teachpath.learning.clustering.subsampled_clustering import MAX_EXACT_DEMONSTRATIONS, cluster_paths
from teachpath.learning.settings import LearningSettings
from teachpath.records import Array
from tests.unit.learning import synthetic

SETTINGS = LearningSettings()


@pytest.fixture(scope="module")
def crowd() -> tuple[Array, Array]:
    """Short paths of three ways, more than are measured pair by pair, and the way of each."""
    rng = np.random.default_rng(1)
    ways = rng.integers(0, 3, MAX_EXACT_DEMONSTRATIONS + 1)
    offsets = np.array([0.0, 0.4, 0.9])[ways][:, None, None]
    return synthetic.loop(6) + offsets + rng.normal(0, 0.01, (len(ways), 1, 3)), ways


def test_all_members_of_a_crowd_are_grouped_by_its_sample(crowd: tuple[Array, Array]) -> None:
    paths, ways = crowd
    grouping = cluster_paths(paths, SETTINGS, length=1.0, metric="arc")
    assert grouping.labels.max() == 3
    assert all(len(set(ways[grouping.labels == label])) == 1 for label in (1, 2, 3))
    assert "by a sample of 2000" in grouping.note
    assert is_valid_linkage(grouping.linkage)
    assert len(grouping.linkage) == len(paths) - 1
    np.testing.assert_array_equal(labels_at_height(grouping.linkage, grouping.threshold), grouping.labels)


def test_one_far_from_all_others_is_alone_only_where_a_threshold_is_set(crowd: tuple[Array, Array]) -> None:
    paths, _ = crowd
    stray = np.concatenate([paths[1:], paths[:1] + 5.0])
    fixed = cluster_paths(stray, LearningSettings(threshold=0.2), length=1.0, metric="arc")
    assert np.sum(fixed.labels == fixed.labels[-1]) == 1
    found = cluster_paths(stray, SETTINGS, length=1.0, metric="arc")
    assert np.sum(found.labels == found.labels[-1]) > 1


def test_grouping_a_crowd_can_be_cancelled(crowd: tuple[Array, Array]) -> None:
    def cancel(fraction: float, _sentence: str) -> None:
        if fraction > 0.1:
            raise Cancelled("enough")

    with pytest.raises(Cancelled):
        cluster_paths(crowd[0], SETTINGS, length=1.0, metric="arc", progress=cancel)


def test_a_few_are_measured_pair_by_pair() -> None:
    paths = synthetic.loop(10) + np.array([0.0, 0.01, 0.5, 0.51])[:, None, None]
    grouping = cluster_paths(paths, SETTINGS, length=1.0, metric="arc")
    assert grouping.labels.tolist() == [1, 1, 2, 2]
