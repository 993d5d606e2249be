"""Laws of the clustering, and how often it is right on demonstrations of known grouping."""

from __future__ import annotations

import numpy as np
import pytest

from teachpath.learning.clustering.average_linkage import average_linkage
from teachpath.learning.clustering.distances import pairwise_distances
from teachpath.learning.clustering.partition import Partition, cut_at, cut_by_separation, cut_into
from teachpath.learning.resampling import at_equal_arc_length, smoothed
from teachpath.learning.summary import ambiguities
from teachpath.records import Array, Trajectory
from tests.unit.learning import synthetic

TRUTH = (1, 2, 3, 3, 2, 1, 3, 1, 3, 1, 2, 1)


def condensed(demonstrations: dict[str, Trajectory]) -> Array:
    return pairwise_distances(np.stack([at_equal_arc_length(smoothed(d), 100) for d in demonstrations.values()]))


def separated(distances: Array, count: int, *, length: float = 1.0, min_separation: float = 2.0) -> Partition:
    return cut_by_separation(average_linkage(distances, count), min_separation=min_separation, length=length)


def grouped(demonstrations: dict[str, Trajectory], min_separation: float = 2.0) -> Partition:
    distances = condensed(demonstrations)
    return separated(distances, len(demonstrations), length=0.8, min_separation=min_separation)


@pytest.mark.parametrize("seed", range(8))
def test_three_ways_are_found_in_spite_of_strong_differences_in_speed(seed: int) -> None:
    grouping = grouped(synthetic.experiment_1(seed, duration_spread=0.45, warp=0.25))
    assert tuple(grouping.labels) == TRUTH


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("wiggle", [0.0, 0.025])
def test_a_single_way_stays_whole(seed: int, wiggle: float) -> None:
    assert set(grouped(synthetic.experiment_2(seed, wiggle=wiggle)).labels) == {1}


@pytest.mark.parametrize("sizes", [(1, 1, 1), (2, 1, 1), (5, 1, 1), (3, 3, 1)])
@pytest.mark.parametrize("seed", range(4))
def test_a_way_shown_once_is_a_cluster(sizes: tuple[int, ...], seed: int) -> None:
    rng = np.random.default_rng(seed)
    truth = rng.permutation(np.repeat([1, 2, 3], sizes))
    labels = grouped(
        {str(i): synthetic.demonstration(rng, synthetic.WAY_POINTS[w - 1]) for i, w in enumerate(truth)}
    ).labels
    np.testing.assert_array_equal(labels[:, None] == labels, truth[:, None] == truth)


@pytest.mark.parametrize("seed", range(8))
def test_a_tidy_hand_of_which_one_wiggles_stays_one_cluster(seed: int) -> None:
    tidy = {"via_spread": 0.003, "end_spread": 0.001, "tremor": 0.0005, "noise": 0.0005}
    assert set(grouped(synthetic.experiment_2(seed, wiggle=0.025, **tidy)).labels) == {1}


def test_twelve_clusters_are_found() -> None:
    labels = separated(places(*np.repeat(np.arange(12) * 0.4, 3)), 36).labels
    np.testing.assert_array_equal(labels, np.repeat(np.arange(12) + 1, 3))


def test_a_lower_least_separation_splits_a_single_way() -> None:
    assert grouped(synthetic.experiment_2(1, wiggle=0.0), min_separation=1.0).labels.max() > 1


@pytest.mark.parametrize(("spread", "clusters"), [(0.001, 2), (0.03, 1)])  # m
def test_the_scatter_within_decides_what_is_apart(spread: float, clusters: int) -> None:
    assert separated(places(*np.repeat([0.0, 0.06], 8), spread=spread), 16).labels.max() == clusters


def test_close_ways_are_told_apart_though_others_are_far_away() -> None:
    rng = np.random.default_rng(3)
    shifts = np.repeat([0.0, 0.08, 1.0, 2.0], 5)
    paths = synthetic.loop(40) + shifts[:, None, None] + rng.normal(0, 0.01, (20, 1, 3))
    grouping = separated(pairwise_distances(paths), 20)
    np.testing.assert_array_equal(grouping.labels, np.repeat([1, 2, 3, 4], 5))


def test_the_cut_reproduces_the_labels_at_its_threshold() -> None:
    distance = condensed(synthetic.experiment_1(4))
    grouping = separated(distance, 12, length=0.8)
    again = cut_at(average_linkage(distance, 12), grouping.threshold)
    np.testing.assert_array_equal(grouping.labels, again.labels)
    np.testing.assert_array_equal(grouping.linkage, again.linkage)


def test_the_order_of_demonstrations_changes_no_partition() -> None:
    demonstrations = synthetic.experiment_1(5)
    order = np.random.default_rng(1).permutation(12)
    names = list(demonstrations)
    shuffled = grouped({names[i]: demonstrations[names[i]] for i in order}).labels
    together = grouped(demonstrations).labels[order]
    np.testing.assert_array_equal(shuffled[:, None] == shuffled, together[:, None] == together)


def test_merges_grow_with_height_and_clusters_are_numbered_by_first_member() -> None:
    grouping = cut_at(average_linkage(condensed(synthetic.experiment_1(6)), 12), 0.08)
    assert np.all(np.diff(grouping.linkage[:, 2]) >= 0)
    first = [int(np.argmax(grouping.labels == k)) for k in range(1, grouping.labels.max() + 1)]
    assert first == sorted(first)


@pytest.mark.parametrize(("threshold", "count"), [(1e-9, 12), (10.0, 1)])
def test_the_extremes_of_the_threshold_give_single_demonstrations_and_one_cluster(threshold: float, count: int) -> None:
    assert cut_at(average_linkage(condensed(synthetic.experiment_1(7)), 12), threshold).labels.max() == count


@pytest.mark.parametrize(("apart", "ways"), [(0.02, 1), (0.3, 2)])
def test_two_demonstrations_are_answered_with_a_note(apart: float, ways: int) -> None:
    grouping = separated(np.array([apart]), 2)
    assert grouping.labels.max() == ways
    assert "learning.threshold" in grouping.note


def test_identical_demonstrations_are_one_way() -> None:
    for count in (2, 3, 5):
        grouping = separated(np.zeros(count * (count - 1) // 2), count)
        assert set(grouping.labels) == {1}
        assert np.isfinite(grouping.threshold)


def test_one_demonstration_is_one_way() -> None:
    grouping = separated(np.empty(0), 1)
    assert grouping.labels.tolist() == [1]
    assert grouping.linkage.shape == (0, 4)


@pytest.mark.parametrize("count", [1, 2, 3, 7, 12])
def test_a_known_number_of_ways_is_cut_into(count: int) -> None:
    tree = average_linkage(condensed(synthetic.experiment_1(8)), 12)
    grouping = cut_into(tree, count)
    assert set(grouping.labels) == set(range(1, count + 1))
    again = cut_at(tree, grouping.threshold)
    np.testing.assert_array_equal(again.labels, grouping.labels)


def test_more_ways_than_demonstrations_are_said_to_be_impossible() -> None:
    grouping = cut_into(average_linkage(np.array([0.1, 0.2, 0.2]), 3), 5)
    assert grouping.labels.tolist() == [1, 2, 3]
    assert "3 demonstrations cannot be 5 ways" in grouping.note


def places(*offsets: float, spread: float = 0.002) -> Array:
    """Distances of copies of one path at these places."""
    rng = np.random.default_rng(4)
    shifted = [synthetic.loop(30) + offset + rng.normal(0, spread, 3) for offset in offsets]
    return pairwise_distances(np.stack(shifted))


def test_a_close_choice_names_the_next_best_cut_and_the_clusters_it_touches() -> None:
    apart = places(0, 0, 0, 0, 0.6, 0.6, 0.6, 0.6, 0.64, 0.64, 0.64, 0.64, spread=0.012)
    grouping = separated(apart, 12)
    assert grouping.alternative is not None
    assert grouping.alternative != grouping.labels.max()
    assert "ambiguous" in grouping.note
    doubts = ambiguities(grouping)
    assert doubts[0] == ""
    assert all("could as well be" in doubt for doubt in doubts[1:])


def test_a_clear_choice_is_not_called_ambiguous() -> None:
    grouping = separated(places(0, 0, 0, 0.5, 0.5, 0.5), 6)
    assert (grouping.note, grouping.alternative) == ("", None)
    assert ambiguities(grouping) == ["", ""]


def test_a_threshold_close_to_a_merge_is_called_ambiguous() -> None:
    apart = places(0, 0.2, spread=0.0)
    tree, height = average_linkage(apart, 2), float(apart[0])
    near, far = cut_at(tree, height * 1.02), cut_at(tree, height * 2)
    assert near.alternative == 2
    assert ambiguities(near) == ["ambiguous: could as well be 2 ways, of 1 and 1 demonstrations"]
    assert "close to learning.threshold" in near.note
    assert far.alternative is None
    assert "together with 2" in ambiguities(cut_at(tree, height * 0.98))[0]
