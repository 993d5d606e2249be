"""Demonstrations that end elsewhere are other clusters, and their merges come last in the dendrogram."""

from __future__ import annotations

import numpy as np
import pytest

from teachpath.io.documents import to_document
from teachpath.learning.clustering.average_linkage import average_linkage
from teachpath.learning.clustering.cuts import recut_members
from teachpath.learning.clustering.dendrogram import labels_for_count
from teachpath.learning.clustering.distances import pairwise_distances
from teachpath.learning.clustering.ends import OF_TASKS, end_groups, grouped_linkage
from teachpath.learning.learn import learn
from teachpath.learning.relearn import relearn
from teachpath.learning.settings import LearningSettings
from teachpath.records import Array, Trajectory
from tests.unit.learning import synthetic

SETTINGS = LearningSettings(repeats=0)


def to_goals(seed: int, *goals: float) -> dict[str, Trajectory]:
    """One way to goals that are so many metres to the side."""
    rng = np.random.default_rng(seed)
    side = np.array([1.0, 0.0, 0.0])
    return {str(i): synthetic.demonstration(rng, goal=synthetic.GOAL + at * side) for i, at in enumerate(goals)}


def ends_of(demonstrations: dict[str, Trajectory]) -> Array:
    return np.stack([d.positions[[0, -1]] for d in demonstrations.values()])


@pytest.mark.parametrize("apart", [0.05, 0.10])
@pytest.mark.parametrize("seed", range(4))
def test_a_path_never_leads_between_two_goals(apart: float, seed: int) -> None:
    demonstrations = to_goals(seed, 0, apart, 0, apart, 0, apart)
    learned = learn(demonstrations, SETTINGS)
    assert [set(cluster.members) for cluster in learned.clusters] == [{"0", "2", "4"}, {"1", "3", "5"}]
    shown = ends_of(demonstrations)[:, 1]
    for path in learned.paths:
        assert np.linalg.norm(path.curve(1.0) - shown, axis=1).min() < 0.01  # the ends scatter by 4 mm on every axis
    assert "starts or goals differ" in learned.notes[0]


def test_an_only_demonstration_to_another_goal_is_a_cluster() -> None:
    learned = learn(to_goals(1, 0, 0, 0, 0, 0, 0.08), SETTINGS)
    assert sorted(map(len, (cluster.members for cluster in learned.clusters))) == [1, 5]


@pytest.mark.parametrize("seed", range(6))
def test_two_demonstrations_have_one_end_or_two(seed: int) -> None:
    for groups, apart in ((1, 0.0), (2, 0.06)):
        assert end_groups(ends_of(to_goals(seed, 0, apart)), min_separation=2.0, length=0.9).max() == groups


@pytest.mark.parametrize("seed", range(6))
def test_ends_that_scatter_are_one_group(seed: int) -> None:
    groups = end_groups(ends_of(to_goals(seed, *[0.0] * 7)), min_separation=2.0, length=0.9)
    assert set(groups) == {1}


def test_starts_that_scatter_widely_about_one_place_are_seldom_parted() -> None:
    rng = np.random.default_rng(1)
    parted = 0
    for _ in range(100):
        ends = np.zeros((12, 2, 3))
        ends[:, 0, :2] = rng.normal(0.0, 0.03, (12, 2))  # m, of paths that are 1 m long, as written letters scatter
        parted += end_groups(ends, min_separation=2.0, length=1.0, scatter=OF_TASKS).max() > 1
    assert parted <= 10


def test_turned_round_the_starts_count_as_the_goals_did() -> None:
    ends = ends_of(to_goals(2, 0, 0.06, 0, 0.06, 0))
    np.testing.assert_array_equal(
        end_groups(ends, min_separation=2.0, length=0.9), end_groups(ends[:, ::-1], min_separation=2.0, length=0.9)
    )


def test_groups_merge_last_in_rising_order_and_one_group_changes_nothing() -> None:
    paths = 0.05 * np.random.default_rng(3).normal(size=(12, 20, 3)).cumsum(axis=1)
    condensed = pairwise_distances(paths)
    groups = np.array([1, 2, 3] * 4)
    tree = grouped_linkage(condensed, groups)
    assert np.all(np.diff(tree[:, 2]) > 0)
    np.testing.assert_array_equal(labels_for_count(tree, 3), groups)
    np.testing.assert_array_equal(grouped_linkage(condensed, np.ones(12, dtype=int)), average_linkage(condensed, 12))


def test_a_run_with_two_goals_can_be_cut_elsewhere_and_back() -> None:
    demonstrations = to_goals(5, 0, 0.08, 0, 0.08, 0, 0.08)
    run = learn(demonstrations, SETTINGS)
    own = tuple(tuple(sorted(cluster.members)) for cluster in run.clusters)
    assert tuple(tuple(sorted(ids)) for ids in recut_members(run, threshold=run.threshold)) == own
    whole = relearn(run, demonstrations, clusters=1)
    assert len(whole.clusters) == 1
    again = learn(demonstrations, LearningSettings(**whole.settings))  # type: ignore[arg-type]
    assert to_document(again) == to_document(whole)


def test_many_ends_are_grouped_as_few_are() -> None:
    rng = np.random.default_rng(7)
    ends = np.zeros((225, 2, 3)) + rng.normal(0, 0.004, (225, 2, 3))
    ends[:, 1, 0] += np.tile([0.0, 0.1, 0.2], 75)
    for count in (150, 225):  # by scipy, and by the compiled kernels
        groups = end_groups(ends[:count], min_separation=2.0, length=0.9)
        np.testing.assert_array_equal(groups, np.tile([1, 2, 3], 75)[:count])
