"""Selection as the paper has it, by the likelihood of a hidden Markov model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from teachpath.learning.selection.paper_mode import select_as_paper
from teachpath.learning.settings import LearningSettings
from teachpath.records import Cluster, Trajectory
from tests.unit.learning import synthetic
from tests.unit.learning.selection.test_selection import kept

PAPER = LearningSettings(mode="paper", threshold=0.08, repeats=0)


def selected_as_paper(demonstrations: dict[str, Trajectory], **changes: object) -> Cluster:
    positions = {name: d.positions for name, d in demonstrations.items()}
    settings = replace(PAPER, **changes)  # type: ignore[arg-type]
    (cluster,) = select_as_paper(positions, [list(demonstrations)], settings, on_step=lambda: None)
    return cluster


def test_mode_paper_keeps_exactly_the_n_best_by_likelihood() -> None:
    cluster = selected_as_paper(synthetic.experiment_2(1))
    likelihoods = [score.log_likelihood for score in cluster.scores]
    assert likelihoods == sorted(likelihoods, reverse=True)
    assert [score.selected for score in cluster.scores] == [True, True, False, False, False]
    assert 2 <= len(cluster.convergence) <= 10
    assert cluster.convergence[-1] > cluster.convergence[0]


def test_mode_paper_repeats_itself_with_the_same_seed_and_not_with_another() -> None:
    demonstrations = synthetic.experiment_2(1)
    assert selected_as_paper(demonstrations).scores == selected_as_paper(dict(reversed(demonstrations.items()))).scores
    assert selected_as_paper(demonstrations).scores != selected_as_paper(demonstrations, seed=2).scores


def test_mode_paper_skips_selection_when_there_are_fewer_than_n() -> None:
    cluster = selected_as_paper({"a": synthetic.experiment_2(1)["1"]})
    assert kept(cluster) == {"a"}
    assert "fewer than 2" in cluster.note


def test_mode_paper_is_on_the_scale_of_the_papers_table() -> None:
    # Table I: -119 to -232 for 159 samples.
    scores = []
    for seed in range(5):
        demonstrations = {k: d for k, d in synthetic.experiment_1(seed).items() if k in {"1", "6", "8", "10", "12"}}
        scores += [score.log_likelihood for score in selected_as_paper(demonstrations, seed=seed).scores]
    assert -232 < np.median(scores) < -119


def test_mode_paper_counts_its_stability_over_other_seeds() -> None:
    cluster = selected_as_paper(synthetic.experiment_2(2), repeats=10)
    stabilities = [score.stability for score in cluster.scores]
    assert all(stability is not None and 0 <= stability <= 1 for stability in stabilities)
    assert sum(s for s in stabilities if s is not None) == pytest.approx(2)  # two of five are kept each time


def test_mode_repaired_rejects_the_wiggly_one_where_mode_paper_guesses() -> None:
    seeds = range(20)
    rates = {
        mode: np.mean(
            [5 not in map(int, kept(selected_as_paper(synthetic.experiment_2(s), mode=mode, seed=s))) for s in seeds]
        )
        for mode in ("paper", "repaired")
    }
    assert rates["repaired"] >= 0.85
    assert rates["paper"] < rates["repaired"]
