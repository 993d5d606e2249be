"""Laws of the clustering, and how often it is right on demonstrations of known grouping."""

from __future__ import annotations

import numpy as np
import pytest
import synthetic
from scipy.spatial.distance import squareform

from teachpath.learning.clustering import Grouping, cut_at, cut_by_silhouette, distances, silhouette
from teachpath.learning.resampling import at_equal_arc_length, smoothed
from teachpath.records import Array, Trajectory

TRUTH = (1, 2, 3, 3, 2, 1, 3, 1, 3, 1, 2, 1)


def condensed(demonstrations: dict[str, Trajectory]) -> Array:
    return distances(np.stack([at_equal_arc_length(smoothed(d), 100) for d in demonstrations.values()]))


def grouped(demonstrations: dict[str, Trajectory], guard: float = 0.5) -> Grouping:
    return cut_by_silhouette(condensed(demonstrations), len(demonstrations), guard=guard, length=0.8)


def test_the_distance_is_the_mean_of_pointwise_distances() -> None:
    rng = np.random.default_rng(1)
    paths = rng.normal(size=(6, 20, 3))
    expected = [[np.mean([np.linalg.norm(p - q) for p, q in zip(a, b, strict=True)]) for b in paths] for a in paths]
    np.testing.assert_allclose(squareform(distances(paths)), expected, atol=1e-12)


def test_the_distance_is_a_metric_of_paths() -> None:
    square = squareform(distances(np.random.default_rng(2).normal(size=(8, 10, 3))))
    assert np.all(square[:, :, None] <= square[:, None, :] + square.T[None, :, :] + 1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_three_ways_are_found_in_spite_of_strong_differences_in_speed(seed: int) -> None:
    grouping = grouped(synthetic.experiment_1(seed, duration_spread=0.45, warp=0.25))
    assert tuple(grouping.labels) == TRUTH


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("wiggle", [0.0, 0.025])
def test_a_single_way_stays_whole(seed: int, wiggle: float) -> None:
    assert set(grouped(synthetic.experiment_2(seed, wiggle=wiggle)).labels) == {1}


def test_without_the_guard_a_single_way_is_split() -> None:
    assert grouped(synthetic.experiment_2(1, wiggle=0.0), guard=0.0).labels.max() > 1


def test_close_ways_are_told_apart_though_others_are_far_away() -> None:
    rng = np.random.default_rng(3)
    shifts = np.repeat([0.0, 0.08, 1.0, 2.0], 5)
    paths = synthetic.loop(40) + shifts[:, None, None] + rng.normal(0, 0.01, (20, 1, 3))
    grouping = cut_by_silhouette(distances(paths), 20, guard=0.5, length=1.0)
    np.testing.assert_array_equal(grouping.labels, np.repeat([1, 2, 3, 4], 5))


def test_the_cut_reproduces_the_labels_at_its_threshold() -> None:
    distance = condensed(synthetic.experiment_1(4))
    grouping = cut_by_silhouette(distance, 12, guard=0.5, length=0.8)
    again = cut_at(distance, 12, grouping.threshold)
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
    grouping = cut_at(condensed(synthetic.experiment_1(6)), 12, 0.08)
    assert np.all(np.diff(grouping.linkage[:, 2]) >= 0)
    first = [int(np.argmax(grouping.labels == k)) for k in range(1, grouping.labels.max() + 1)]
    assert first == sorted(first)


@pytest.mark.parametrize(("threshold", "count"), [(1e-9, 12), (10.0, 1)])
def test_the_extremes_of_the_threshold_give_single_demonstrations_and_one_cluster(threshold: float, count: int) -> None:
    assert cut_at(condensed(synthetic.experiment_1(7)), 12, threshold).labels.max() == count


@pytest.mark.parametrize(("apart", "ways"), [(0.02, 1), (0.3, 2)])
def test_two_demonstrations_are_answered_with_a_note(apart: float, ways: int) -> None:
    grouping = cut_by_silhouette(np.array([apart]), 2, guard=0.5, length=1.0)
    assert grouping.labels.max() == ways
    assert "learning.threshold" in grouping.note


def test_identical_demonstrations_are_one_way() -> None:
    for count in (2, 3, 5):
        grouping = cut_by_silhouette(np.zeros(count * (count - 1) // 2), count, guard=0.5, length=1.0)
        assert set(grouping.labels) == {1}
        assert np.isfinite(grouping.threshold)


def test_one_demonstration_is_one_way() -> None:
    grouping = cut_by_silhouette(np.empty(0), 1, guard=0.5, length=1.0)
    assert grouping.labels.tolist() == [1]
    assert grouping.linkage.shape == (0, 4)


def test_the_silhouette_is_one_for_points_in_two_places_and_negative_when_mixed_up() -> None:
    square = np.abs(np.subtract.outer([0.0, 0, 1, 1], [0.0, 0, 1, 1]))
    assert silhouette(square, np.array([1, 1, 2, 2])) == pytest.approx(1.0)
    assert silhouette(square, np.array([1, 2, 1, 2])) < 0
