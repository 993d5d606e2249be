"""A demonstration that stops early is named with its place, and neither makes a cluster nor moves a goal."""

from __future__ import annotations

import numpy as np
import pytest

from teachpath.io.documents import to_document
from teachpath.learning.learn import learn
from teachpath.learning.relearn import relearn
from teachpath.learning.resampling import arc_lengths, smoothed
from teachpath.learning.settings import LearningSettings
from teachpath.records import Learned, Trajectory
from tests.unit.learning import synthetic

SETTINGS = LearningSettings(repeats=2)


def cut_off(trajectory: Trajectory, share: float) -> Trajectory:
    along = arc_lengths(smoothed(trajectory))
    last = int(np.searchsorted(along, share * along[-1]))
    return Trajectory(trajectory.times[:last], trajectory.positions[:last])


def one_stops(seed: int, share: float, count: int = 6) -> dict[str, Trajectory]:
    shown = synthetic.experiment_2(seed, wiggle=0.0, count=count)
    return {**shown, "3": cut_off(shown["3"], share)}


@pytest.mark.parametrize("share", [0.5, 0.7, 0.88])
@pytest.mark.parametrize("seed", range(3))
def test_it_is_named_with_its_place_and_left_out(share: float, seed: int) -> None:
    learned = learn(one_stops(seed, share), SETTINGS)
    (cluster,) = learned.clusters
    score = cluster.scores[-1]
    assert (score.demonstration, score.selected, score.z) == ("3", False, None)
    assert score.deviation is not None
    assert score.deviation.share == (pytest.approx(share, abs=0.05), 1.0)
    assert score.note == score.deviation.sentence
    assert f"demonstration 3 {score.note}" in learned.notes
    assert "incomplete" in score.note
    assert set(cluster.members) == set(learned.demonstrations)
    assert cluster.representative != "3"


def test_the_others_are_learned_as_if_it_had_not_been_shown() -> None:
    shown = one_stops(1, 0.7)
    learned = learn(shown, SETTINGS)
    without = learn({name: each for name, each in shown.items() if name != "3"}, SETTINGS)
    assert [to_document(path) for path in learned.paths] == [to_document(path) for path in without.paths]
    assert learned.clusters[0].scores[:-1] == without.clusters[0].scores
    assert learned.threshold == without.threshold


def test_it_belongs_to_the_way_that_it_follows() -> None:
    shown = synthetic.experiment_1(2)
    before = {tuple(sorted(cluster.members)) for cluster in learn(shown, SETTINGS).clusters}
    after = learn({**shown, "7": cut_off(shown["7"], 0.8)}, SETTINGS)
    assert {tuple(sorted(cluster.members)) for cluster in after.clusters} == before
    (own,) = [s for cluster in after.clusters for s in cluster.scores if s.demonstration == "7"]
    assert not own.selected


def test_a_run_cut_elsewhere_names_it_as_learning_from_the_beginning_does() -> None:
    shown = {**synthetic.experiment_1(2), "7": cut_off(synthetic.experiment_1(2)["7"], 0.8)}
    again: Learned = relearn(learn(shown, SETTINGS), shown, clusters=2)
    assert any("incomplete" in note for note in again.notes)
    settings = LearningSettings(**again.settings)  # type: ignore[arg-type]
    assert to_document(learn(shown, settings)) == to_document(again)


@pytest.mark.parametrize("seed", range(6))
def test_whole_demonstrations_are_not_called_incomplete(seed: int) -> None:
    for shown in (synthetic.experiment_1(seed), synthetic.experiment_2(seed), synthetic.experiment_2(seed, count=3)):
        assert not any("incomplete" in note for note in learn(shown, LearningSettings(repeats=0)).notes)


def test_of_two_that_end_differently_neither_is_called_incomplete() -> None:
    learned = learn(one_stops(1, 0.6, count=3), SETTINGS)
    assert any("incomplete" in note for note in learned.notes)
    two = {name: each for name, each in one_stops(1, 0.6, count=3).items() if name != "1"}
    assert not any("incomplete" in note for note in learn(two, SETTINGS).notes)


def test_mode_paper_knows_nothing_of_it() -> None:
    learned = learn(one_stops(1, 0.8), LearningSettings(mode="paper", threshold=1.0, repeats=0))
    assert not any("incomplete" in note for note in learned.notes)
