"""Ways between moving starts and goals: found wherever they are, told by learning, and kept apart where they differ."""

from __future__ import annotations

import re

import numpy as np
import pytest

from teachpath.learning.adaptation.same_way import labels_of_ways, moving_ends
from teachpath.learning.learn import learn
from teachpath.learning.resampling import at_equal_arc_length, smoothed
from teachpath.learning.settings import LearningSettings
from teachpath.records import Array, Trajectory
from tests.unit.learning import synthetic

SEPARATION = LearningSettings().min_separation
SAME_CLUSTERS = re.compile(
    r"clusters ([\d, ]+) and (\d+) do the task in the same way, .* to goals up to (\d+) cm apart"
)


def moved(way: int, shift: Array, seed: int) -> Trajectory:
    rng = np.random.default_rng([seed, way])
    return synthetic.demonstration(rng, synthetic.WAY_POINTS[way], goal=synthetic.GOAL + shift)


def courses(shown: list[Trajectory]) -> Array:
    return np.array([at_equal_arc_length(smoothed(each), 100) for each in shown])


def shifts(count: int, seed: int) -> Array:
    return np.random.default_rng(seed).uniform(-0.08, 0.08, (count, 3)) * [1, 1, 0]


@pytest.mark.parametrize("seed", range(5))
def test_ways_are_told_apart_wherever_their_goals_are(seed: int) -> None:
    truth = [0, 2, 0, 2, 2, 0]
    shown = courses([moved(way, shift, i) for i, (way, shift) in enumerate(zip(truth, shifts(6, seed), strict=True))])
    found = labels_of_ways(shown, shown[:, 0].mean(axis=0), shown[:, -1].mean(axis=0), min_separation=SEPARATION)
    assert found.tolist() == [1, 2, 1, 2, 2, 1]


def test_learning_says_which_clusters_do_the_task_in_the_same_way() -> None:
    goals = np.array([[0, 0, 0], [0.15, 0, 0]])
    shown = {str(i): moved(1, goals[i % 2], i) for i in range(8)}
    learned = learn(shown, LearningSettings(repeats=0))
    assert len(learned.clusters) == 2
    (told,) = [match for note in learned.notes if (match := SAME_CLUSTERS.match(note))]
    assert told.group(1, 2) == ("1", "2")
    assert float(told[3]) == pytest.approx(15, abs=2)


def test_nothing_is_said_of_ways_between_the_same_ends_nor_of_one_place() -> None:
    for demonstrations in (synthetic.experiment_1(3), synthetic.experiment_2(3, wiggle=0.0)):
        assert not [
            note for note in learn(demonstrations, LearningSettings(repeats=0)).notes if SAME_CLUSTERS.match(note)
        ]


def test_each_way_has_its_own_sentence() -> None:
    plan = [(0, 0.0), (2, 0.0), (0, 0.15), (2, 0.15)]
    shown = courses([moved(way, np.array([shift, 0, 0]), i) for i, (way, shift) in enumerate(plan)])
    told = [
        match.group(1, 2)
        for note in moving_ends(shown, min_separation=SEPARATION)
        if (match := SAME_CLUSTERS.match(note))
    ]
    assert told == [("1", "3"), ("2", "4")]
