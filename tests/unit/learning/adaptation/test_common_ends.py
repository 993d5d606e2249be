"""A task with a moving start or goal: found by itself, one way, its path between ends that were shown."""

from __future__ import annotations

import numpy as np
import pytest

from teachpath.learning.learn import learn
from teachpath.learning.relearn import relearn
from teachpath.learning.settings import LearningSettings
from teachpath.records import Learned, Trajectory
from tests.unit.learning import synthetic

SETTINGS = LearningSettings(repeats=0)


def shown(count: int, *, start: float, goal: float, ways: tuple[int, ...] = (1,)) -> dict[str, Trajectory]:
    """Demonstrations whose starts and goals scatter by so much [m] on the table."""
    rng = np.random.default_rng(3)
    found = {}
    for number in range(count):
        shift, more = rng.normal(0, start, 3) * [1, 1, 0], rng.normal(0, goal, 3) * [1, 1, 0]
        way = synthetic.WAY_POINTS[ways[number % len(ways)]]
        one = synthetic.demonstration(rng, way, goal=synthetic.GOAL + more - shift)
        found[f"demo-{number}"] = Trajectory(one.times, one.positions + shift, one.orientations)
    return found


def ends(demonstrations: dict[str, Trajectory]) -> list[np.ndarray]:
    return [each.positions[[0, -1]] for each in demonstrations.values()]


@pytest.fixture(scope="module")
def moving() -> dict[str, Trajectory]:
    return shown(6, start=0.05, goal=0.05)


@pytest.fixture(scope="module")
def learned(moving: dict[str, Trajectory]) -> Learned:
    return learn(moving, SETTINGS)


def test_one_way_is_learned_between_ends_that_were_shown(learned: Learned, moving: dict[str, Trajectory]) -> None:
    (cluster,) = learned.clusters
    assert set(cluster.members) == set(moving)
    assert learned.notes[0].startswith("a task with a moving start and goal: ")
    begins, leads = learned.paths[0].curve(np.array([0.0, 1.0]))
    nearest = min(np.linalg.norm(each - [begins, leads], axis=1).max() for each in ends(moving))
    assert nearest < 1e-9


def test_its_spread_is_that_of_the_shapes_and_not_of_the_ends(learned: Learned, moving: dict[str, Trajectory]) -> None:
    spread = learned.clusters[0].spread
    assert spread is not None
    assert spread[[0, -1]].max() < 1e-9 < 0.01 < spread.max()
    assert np.ptp(ends(moving), axis=0).max() > 0.1


@pytest.mark.parametrize(("start", "goal", "moves"), [(0.08, 0.0, "start"), (0.0, 0.08, "goal")])
def test_the_end_that_moves_is_named(start: float, goal: float, moves: str) -> None:
    notes = learn(shown(5, start=start, goal=goal), SETTINGS).notes
    assert notes[0].startswith(f"a task with a moving {moves}: {moves}s up to ")


def test_ways_stay_ways_where_the_ends_move() -> None:
    demonstrations = shown(6, start=0.05, goal=0.05, ways=(0, 2))
    found = learn(demonstrations, SETTINGS)
    names = list(demonstrations)
    assert [set(cluster.members) for cluster in found.clusters] == [set(names[::2]), set(names[1::2])]


@pytest.mark.parametrize("places", [1, 2])
def test_one_place_or_two_that_are_shown_again_are_no_moving_task(places: int) -> None:
    rng = np.random.default_rng(4)
    goals = [synthetic.GOAL, synthetic.GOAL + np.array([0.15, 0.0, 0.0])][:places]
    demonstrations = {
        str(number): synthetic.demonstration(rng, synthetic.WAY_POINTS[1], goal=goals[number % places])
        for number in range(6)
    }
    found = learn(demonstrations, SETTINGS)
    assert len(found.clusters) == places
    assert not any("moving" in note for note in found.notes)


def test_another_cut_gives_what_learning_with_it_gives(learned: Learned, moving: dict[str, Trajectory]) -> None:
    again = relearn(learned, moving, clusters=2)
    anew = learn(moving, LearningSettings(repeats=0, clusters=2))
    assert [cluster.members for cluster in again.clusters] == [cluster.members for cluster in anew.clusters]
    np.testing.assert_array_equal(again.paths[0].curve.control_points, anew.paths[0].curve.control_points)
