"""A cut can be moved without the distances: the same partitions as scipy's, for every height and number."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.cluster.hierarchy import fcluster, is_valid_linkage, linkage
from scipy.spatial.distance import pdist

from teachpath.errors import UnusableSettings
from teachpath.learning import recut
from teachpath.learning.dendrogram import grafted, height_between, labels_at, labels_into
from teachpath.records import Array, Learned


def tree(seed: int = 1, count: int = 15) -> Array:
    return linkage(pdist(np.random.default_rng(seed).normal(size=(count, 3))), "average")


def same_partition(one: Array, other: Array) -> bool:
    return bool(np.array_equal(one[:, None] == one, other[:, None] == other))


@pytest.mark.parametrize("seed", range(4))
def test_cuts_agree_with_scipy(seed: int) -> None:
    linked = tree(seed)
    for height in np.linspace(0.01, linked[-1, 2] * 1.1, 25):
        assert same_partition(labels_at(linked, height), fcluster(linked, height, "distance"))
    for count in range(1, 16):
        labels = labels_into(linked, count)
        assert same_partition(labels, fcluster(linked, count, "maxclust"))
        assert set(labels) == set(range(1, count + 1))
        assert same_partition(labels_at(linked, height_between(linked, count)), labels)


def test_clusters_are_numbered_by_their_first_members() -> None:
    labels = labels_into(tree(), 6)
    first = [int(np.argmax(labels == k)) for k in range(1, 7)]
    assert first == sorted(first)


def test_a_finer_cut_only_splits() -> None:
    linked = tree()
    for count in range(1, 15):
        fine, coarse = labels_into(linked, count + 1), labels_into(linked, count)
        assert all(len(set(coarse[fine == label])) == 1 for label in set(fine))


def run(names: str = "abcdefgh") -> Learned:
    linked = tree(3, len(names))
    return Learned("default", tuple(names), linked, height_between(linked, 3), (), ())


def test_a_run_is_cut_again_by_height_or_number() -> None:
    learned = run()
    three = recut(learned, clusters=3)
    assert recut(learned, threshold=learned.threshold) == three
    assert sorted("".join("".join(group) for group in three)) == sorted(learned.demonstrations)
    assert recut(learned, clusters=8) == tuple((name,) for name in learned.demonstrations)
    assert recut(learned, threshold=1e3) == (learned.demonstrations,)


def test_one_demonstration_can_only_be_one_way() -> None:
    one = Learned("default", ("a",), np.empty((0, 4)), 0.0, (), ())
    assert recut(one, clusters=1) == recut(one, threshold=0.1) == (("a",),)


@pytest.mark.parametrize(
    ("cut", "sentence"),
    [
        ({}, "give one of the two"),
        ({"threshold": 0.1, "clusters": 2}, "give one of the two"),
        ({"threshold": 0.0}, "greater than 0"),
        ({"threshold": float("nan")}, "greater than 0"),
        ({"clusters": 0}, "give 1 to 8"),
        ({"clusters": 9}, "give 1 to 8"),
    ],
)
def test_an_impossible_cut_is_refused_in_words(cut: dict[str, float], sentence: str) -> None:
    with pytest.raises(UnusableSettings, match=sentence):
        recut(run(), **cut)  # type: ignore[arg-type]


def test_those_outside_the_sample_are_grafted_on_where_they_join() -> None:
    sample = np.array([1, 3, 4, 6])
    of_sample = linkage(pdist(np.array([[0.0], [0.1], [5.0], [5.3]])), "average")
    joins = np.array([1, 1, 3, 3, 4, 4, 6, 6])
    heights = np.array([0.05, 0.0, 0.2, 0.0, 0.0, 9.0, 0.0, 0.01])
    linked = grafted(of_sample, sample, joins, heights)
    assert is_valid_linkage(linked)
    assert np.all(np.diff(linked[:, 2]) >= 0)
    assert labels_at(linked, 1.0).tolist() == [1, 1, 1, 1, 2, 3, 2, 2]
    assert same_partition(labels_at(linked, 1.0)[sample], labels_at(of_sample, 1.0))
