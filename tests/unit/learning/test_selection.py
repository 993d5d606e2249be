"""Who is found inconsistent, wherever it stands in the list; and that nobody is when nobody is."""

from __future__ import annotations

import re

import numpy as np
import pytest
import synthetic

from teachpath.learning.selection import models_to_train, select, select_as_paper
from teachpath.learning.settings import LearningSettings
from teachpath.learning.symbols import spectra, symbol_sequences
from teachpath.records import Cluster, Trajectory

SETTINGS = LearningSettings()
PAPER = LearningSettings(mode="paper", threshold=0.08)


def selected(demonstrations: dict[str, Trajectory], settings: LearningSettings = SETTINGS) -> Cluster:
    return select(1, demonstrations, settings, tick=lambda: None)


def selected_as_paper(demonstrations: dict[str, Trajectory], seed: int = 1) -> Cluster:
    rng = np.random.default_rng(seed)
    sequences = symbol_sequences([spectra(d.positions) for d in demonstrations.values()], 64, rng)
    return select_as_paper(1, dict(zip(demonstrations, sequences, strict=True)), PAPER, rng, tick=lambda: None)


def kept(cluster: Cluster) -> set[str]:
    return {score.demonstration for score in cluster.scores if score.selected}


@pytest.mark.parametrize("marked", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("wiggle", [0.025, 0.005])
def test_the_wiggly_demonstration_is_rejected_at_any_place_in_the_list(marked: int, wiggle: float) -> None:
    cluster = selected(synthetic.experiment_2(10 + marked, wiggle=wiggle, marked=marked))
    assert cluster.members[-1] == str(marked)
    assert str(marked) not in kept(cluster)
    assert "smoothness" in cluster.scores[-1].note
    assert len(kept(cluster)) >= 3


def test_the_note_says_when_a_demonstration_departs() -> None:
    demonstrations = synthetic.experiment_2(7, wiggle=0.0)
    frozen = demonstrations["3"]
    positions = frozen.positions.copy()
    positions[100:115] = positions[100]  # from 2.0 to 2.3 s
    cluster = selected({**demonstrations, "3": Trajectory(frozen.times, positions)})
    note = cluster.scores[-1].note
    begin, end = (float(word) for word in re.findall(r"from ([\d.]+) to ([\d.]+) s", note)[0])
    assert cluster.members[-1] == "3"
    assert 1.0 < begin <= 2.3
    assert 2.0 <= end < 3.3


@pytest.fixture(scope="module")
def without_wiggle() -> list[Cluster]:
    return [selected(synthetic.experiment_2(seed, wiggle=0.0)) for seed in range(30)]


def test_without_wiggle_the_marked_one_is_treated_like_the_others(without_wiggle: list[Cluster]) -> None:
    rejected = np.mean([cluster.members.index("5") >= 2 for cluster in without_wiggle])  # keep 2 of 5: chance is 0.6
    assert abs(rejected - 0.6) <= 3 * np.sqrt(0.6 * 0.4 / len(without_wiggle))


def test_consistent_demonstrations_are_seldom_called_inconsistent(without_wiggle: list[Cluster]) -> None:
    flagged = np.mean([1 - len(kept(cluster)) / 5 for cluster in without_wiggle])
    assert flagged <= 0.08


def test_ranking_does_not_depend_on_the_order_or_the_frame() -> None:
    demonstrations = synthetic.experiment_2(3)
    rotation = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    here = selected(demonstrations)
    for other in (
        selected(dict(reversed(demonstrations.items()))),
        selected(synthetic.moved(demonstrations, rotation, np.array([1.0, 2.0, 3.0]))),
    ):
        assert other.members == here.members
        assert kept(other) == kept(here)
        np.testing.assert_allclose(
            [score.log_likelihood for score in other.scores],
            [score.log_likelihood for score in here.scores],
            rtol=1e-6,
        )


@pytest.mark.parametrize("keep", [1, 3, 5, 9])
def test_at_least_the_demanded_number_is_kept(keep: int) -> None:
    cluster = selected(synthetic.experiment_2(4), LearningSettings(keep=keep, inconsistent=0.0))
    assert len(kept(cluster)) >= min(keep, 5)


def test_one_demonstration_is_kept_unscored() -> None:
    cluster = selected({"a": synthetic.experiment_2(1)["1"]})
    assert kept(cluster) == {"a"}
    assert "one demonstration only" in cluster.note


def test_identical_demonstrations_are_all_consistent() -> None:
    one = synthetic.experiment_2(1)["1"]
    for names in ("ab", "abc", "abcde"):
        cluster = selected(dict.fromkeys(names, one))
        assert kept(cluster) == set(names)
        assert np.all(np.isfinite([score.log_likelihood for score in cluster.scores]))


def test_demonstrations_shorter_than_the_window_are_judged_by_their_course() -> None:
    rng = np.random.default_rng(5)
    cluster = selected({str(i): synthetic.demonstration(rng, duration=0.3) for i in range(5)})
    assert "shorter than the analysis window" in cluster.note
    assert np.all(np.isfinite([score.log_likelihood for score in cluster.scores]))


def test_many_demonstrations_are_judged_in_folds() -> None:
    rng = np.random.default_rng(6)
    crowd = {f"{i:02}": synthetic.demonstration(rng, wiggle=0.025 * (i == 17)) for i in range(33)}
    ticks: list[int] = []
    cluster = select(1, crowd, SETTINGS, tick=lambda: ticks.append(1))
    assert cluster.members[-1] == "17"
    assert len(ticks) == models_to_train([33]) < 33


def test_mode_paper_keeps_exactly_the_n_best_by_likelihood() -> None:
    cluster = selected_as_paper(synthetic.experiment_2(1))
    likelihoods = [score.log_likelihood for score in cluster.scores]
    assert likelihoods == sorted(likelihoods, reverse=True)
    assert [score.selected for score in cluster.scores] == [True, True, False, False, False]
    assert 2 <= len(cluster.convergence) <= 10
    assert cluster.convergence[-1] > cluster.convergence[0]


def test_mode_paper_repeats_itself_with_the_same_seed_and_not_with_another() -> None:
    demonstrations = synthetic.experiment_2(1)
    assert selected_as_paper(demonstrations).scores == selected_as_paper(demonstrations).scores
    assert selected_as_paper(demonstrations).scores != selected_as_paper(demonstrations, seed=2).scores


def test_mode_paper_skips_selection_when_there_are_fewer_than_n() -> None:
    cluster = selected_as_paper({"a": synthetic.experiment_2(1)["1"]})
    assert kept(cluster) == {"a"}
    assert "fewer than 2" in cluster.note
