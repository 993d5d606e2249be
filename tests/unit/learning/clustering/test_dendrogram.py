"""A cut can be moved without the distances: the same partitions as scipy's, for every height and number."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.cluster.hierarchy import fcluster, is_valid_linkage, linkage
from scipy.spatial.distance import pdist

from teachpath.learning.clustering.dendrogram import (
    extended_linkage,
    height_for_count,
    labels_at_height,
    labels_for_count,
    leaf_order,
)
from teachpath.records import Array


def tree(seed: int = 1, count: int = 15) -> Array:
    return linkage(pdist(np.random.default_rng(seed).normal(size=(count, 3))), "average")


def same_partition(one: Array, other: Array) -> bool:
    return bool(np.array_equal(one[:, None] == one, other[:, None] == other))


@pytest.mark.parametrize("seed", range(4))
def test_cuts_agree_with_scipy(seed: int) -> None:
    linked = tree(seed)
    for height in np.linspace(0.01, linked[-1, 2] * 1.1, 25):
        assert same_partition(labels_at_height(linked, height), fcluster(linked, height, "distance"))
    for count in range(1, 16):
        labels = labels_for_count(linked, count)
        assert same_partition(labels, fcluster(linked, count, "maxclust"))
        assert set(labels) == set(range(1, count + 1))
        assert same_partition(labels_at_height(linked, height_for_count(linked, count)), labels)


def test_clusters_are_numbered_by_their_first_members() -> None:
    labels = labels_for_count(tree(), 6)
    first = [int(np.argmax(labels == k)) for k in range(1, 7)]
    assert first == sorted(first)


def test_a_finer_cut_only_splits() -> None:
    linked = tree()
    for count in range(1, 15):
        fine, coarse = labels_for_count(linked, count + 1), labels_for_count(linked, count)
        assert all(len(set(coarse[fine == label])) == 1 for label in set(fine))


@pytest.mark.parametrize("seed", range(4))
def test_the_members_of_every_cluster_are_neighbours_among_the_leaves(seed: int) -> None:
    linked = tree(seed)
    order = leaf_order(linked)
    assert sorted(order) == list(range(15))
    for count in range(1, 16):
        along = labels_for_count(linked, count)[order]
        assert np.count_nonzero(np.diff(along)) == count - 1


def test_a_chain_of_thousands_is_no_obstacle() -> None:
    count = 3000
    names = np.concatenate([[0], np.arange(count, 2 * count - 2)])
    linked = np.column_stack([np.arange(1, count), names, np.arange(1, count), np.arange(2, count + 1)]).astype(float)
    assert leaf_order(linked).tolist() == list(range(count))


def test_those_outside_the_sample_are_grafted_on_where_they_join() -> None:
    sample = np.array([1, 3, 4, 6])
    of_sample = linkage(pdist(np.array([[0.0], [0.1], [5.0], [5.3]])), "average")
    joins = np.array([1, 1, 3, 3, 4, 4, 6, 6])
    heights = np.array([0.05, 0.0, 0.2, 0.0, 0.0, 9.0, 0.0, 0.01])
    linked = extended_linkage(of_sample, sample, joins, heights)
    assert is_valid_linkage(linked)
    assert np.all(np.diff(linked[:, 2]) >= 0)
    assert labels_at_height(linked, 1.0).tolist() == [1, 1, 1, 1, 2, 3, 2, 2]
    assert same_partition(labels_at_height(linked, 1.0)[sample], labels_at_height(of_sample, 1.0))
