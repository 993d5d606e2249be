"""A run cut elsewhere: what the cuts would leave, and what is learned from one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.cluster.hierarchy import linkage
from scipy.spatial.distance import pdist

from teachpath.errors import LearningFailed, UnusableSettings
from teachpath.io.documents import to_document
from teachpath.learning.clustering.cuts import dendrogram, recut_members
from teachpath.learning.clustering.dendrogram import height_for_count
from teachpath.learning.compare import compare
from teachpath.learning.learn import learn
from teachpath.learning.relearn import relearn
from teachpath.learning.settings import LearningSettings
from teachpath.records import Array, Learned, Trajectory
from tests.unit.learning import synthetic


def tree(seed: int, count: int) -> Array:
    return linkage(pdist(np.random.default_rng(seed).normal(size=(count, 3))), "average")


def run(names: str = "abcdefgh") -> Learned:
    linked = tree(3, len(names))
    return Learned("default", tuple(names), linked, height_for_count(linked, 3), (), ())


def test_a_run_is_cut_again_by_height_or_number() -> None:
    learned = run()
    three = recut_members(learned, clusters=3)
    assert recut_members(learned, threshold=learned.threshold) == three
    assert sorted("".join("".join(group) for group in three)) == sorted(learned.demonstrations)
    assert recut_members(learned, clusters=8) == tuple((name,) for name in learned.demonstrations)
    assert recut_members(learned, threshold=1e3) == (learned.demonstrations,)


def test_one_demonstration_can_only_be_one_way() -> None:
    one = Learned("default", ("a",), np.empty((0, 4)), 0.0, (), ())
    assert recut_members(one, clusters=1) == recut_members(one, threshold=0.1) == (("a",),)


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
        recut_members(run(), **cut)  # type: ignore[arg-type]


def test_every_listed_cut_is_the_one_that_is_made() -> None:
    learned = run()
    drawn = dendrogram(learned, 30)
    assert [cut.clusters for cut in drawn.cuts] == list(range(1, 9))
    assert (drawn.threshold, drawn.demonstrations) == (learned.threshold, learned.demonstrations)
    for cut in drawn.cuts:
        ways = recut_members(learned, clusters=cut.clusters)
        assert [set(drawn.leaves[begin:end]) for begin, end in cut.leaf_ranges] == [set(way) for way in ways]
        assert recut_members(learned, threshold=cut.height) == ways
        assert cut.lowest <= cut.height
        assert cut.highest is None or recut_members(learned, threshold=cut.highest) != ways
    assert len(dendrogram(learned, 3).cuts) == 3


def test_a_single_demonstration_has_one_cut() -> None:
    drawn = dendrogram(Learned("default", ("a",), np.empty((0, 4)), 0.0, (), ()), 30)
    assert (drawn.leaves, drawn.merges) == (("a",), ())
    assert [cut.leaf_ranges for cut in drawn.cuts] == [((0, 1),)]


@pytest.mark.parametrize("mode", ["default", "paper"])
@pytest.mark.parametrize("cut", [{"clusters": 2}, {"clusters": 5}, {"threshold": 0.03}])
def test_learning_from_a_cut_is_learning_with_it_from_the_beginning(
    twelve: dict[str, Trajectory], mode: str, cut: dict[str, float]
) -> None:
    settings = LearningSettings(mode=mode, threshold=0.08, repeats=2, error_bound=0.02)
    first = learn(twelve, settings)
    again = relearn(first, dict(reversed(twelve.items())), **cut)  # type: ignore[arg-type]
    assert len(again.clusters) == cut.get("clusters", len(recut_members(first, threshold=0.03)))
    assert to_document(again) == to_document(learn(twelve, LearningSettings(**again.settings)))  # type: ignore[arg-type]
    assert any(sentence.startswith("setting") for sentence in compare(first, again))


def test_a_cut_where_it_was_changes_no_path(learned: Learned, twelve: dict[str, Trajectory]) -> None:
    again = relearn(learned, twelve, threshold=learned.threshold)
    assert [to_document(path) for path in again.paths] == [to_document(path) for path in learned.paths]
    assert again.settings["threshold"] == learned.threshold


def test_demonstrations_that_changed_or_went_are_named(learned: Learned, twelve: dict[str, Trajectory]) -> None:
    fewer = {name: each for name, each in twelve.items() if name != "7"}
    with pytest.raises(LearningFailed, match=r"demonstration 7 is no longer learned from .* learn anew") as refused:
        relearn(learned, fewer, clusters=2)
    assert refused.value.demonstration == "7"
    trimmed = fewer | {"7": Trajectory(twelve["7"].times[:-5], twelve["7"].positions[:-5])}
    with pytest.raises(LearningFailed, match=r"demonstration 7 has changed .* learn anew"):
        relearn(learned, trimmed, clusters=2)
    more = twelve | {"13": synthetic.experiment_2(1)["1"]}
    assert "13" not in relearn(learned, more, clusters=2).demonstrations


def test_a_run_of_another_version_is_cut_with_the_settings_it_kept(
    learned: Learned, twelve: dict[str, Trajectory]
) -> None:
    old = replace(learned, settings={"keep": 3, "forgotten": 1}, inputs={})
    again = relearn(old, twelve, clusters=2)
    assert again.settings["keep"] == 3
    assert "forgotten" not in again.settings


def test_merges_of_one_height_cannot_be_told_apart_by_one() -> None:
    equal = np.array([[0, 1, 0.1, 2], [2, 3, 0.1, 3]], dtype=float)
    learned = Learned("paper", ("a", "b", "c"), equal, 0.2, (), ())
    with pytest.raises(UnusableSettings, match="no height leaves 2 clusters"):
        recut_members(learned, clusters=2)
    assert len(recut_members(replace(learned, mode="default"), clusters=2)) == 2
