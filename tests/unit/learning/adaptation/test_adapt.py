"""Adapted paths: the version itself at its own ends, the shown way elsewhere, and only demonstrations of that way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from teachpath.errors import UnusableInput
from teachpath.learning.adaptation.adapt import STATIONS, AdaptedPath, adapt
from teachpath.learning.adaptation.even_parameters import even_parameters
from teachpath.learning.adaptation.target import Target
from teachpath.learning.fitting.orientation_fit import mean_orientations, rotation_angles
from teachpath.learning.learn import learn
from teachpath.learning.resampling import arc_lengths
from teachpath.learning.settings import LearningSettings
from teachpath.nurbs import unit_quaternions
from teachpath.records import Array, LearnedPath, Trajectory
from tests.unit.learning import synthetic

SETTINGS = LearningSettings(repeats=0)
U = np.linspace(0.0, 1.0, 201)
GOAL_OFFSET = np.array([0.08, 0.05, 0.0])


def several(count: int, way: int = 1, *, seed: int = 1, goal_spread: float = 0.0) -> list[Trajectory]:
    rng = np.random.default_rng([seed, way])
    goals = synthetic.GOAL + rng.normal(0, goal_spread, (count, 3)) * [1, 1, 0]
    return [synthetic.demonstration(rng, synthetic.WAY_POINTS[way], goal=goal) for goal in goals]


def path_of(shown: list[Trajectory]) -> LearnedPath:
    named = {str(i): trajectory for i, trajectory in enumerate(shown)}
    return learn(named, replace(SETTINGS, clusters=1)).paths[0]


def to(path: LearnedPath, shift: Array = GOAL_OFFSET) -> Target:
    return Target(path.curve(0.0), path.curve(1.0) + shift)


@pytest.fixture(scope="module")
def shown() -> list[Trajectory]:
    return several(5)


@pytest.fixture(scope="module")
def learned(shown: list[Trajectory]) -> LearnedPath:
    return path_of(shown)


@pytest.fixture(scope="module")
def adapted(learned: LearnedPath, shown: list[Trajectory]) -> AdaptedPath:
    return adapt(learned, learned.curve, shown, [], to(learned), SETTINGS)


def test_at_its_own_ends_a_path_stays_as_it_is(learned: LearnedPath, shown: list[Trajectory]) -> None:
    same = adapt(learned, learned.curve, shown, [], to(learned, np.zeros(3)), SETTINGS)
    np.testing.assert_allclose(same.curve(U), learned.curve(U), atol=1e-9)


def test_the_ends_are_exact(learned: LearnedPath, adapted: AdaptedPath) -> None:
    np.testing.assert_allclose(adapted.curve(0.0), learned.curve(0.0), atol=1e-9)
    np.testing.assert_allclose(adapted.curve(1.0), learned.curve(1.0) + GOAL_OFFSET, atol=1e-9)


def test_an_adapted_path_adapted_back_is_the_learned_one_but_for_the_fit(
    learned: LearnedPath, shown: list[Trajectory], adapted: AdaptedPath
) -> None:
    back = adapt(replace(learned, curve=adapted.curve), learned.curve, shown, [], to(learned, np.zeros(3)), SETTINGS)
    assert np.linalg.norm(back.curve(U) - learned.curve(U), axis=1).max() < 2 * SETTINGS.error_bound


def test_an_edit_is_moved_along_with_the_task(learned: LearnedPath, shown: list[Trajectory]) -> None:
    points = learned.curve.control_points.copy()
    points[3] += [0.0, 0.0, 0.06]
    edited = replace(learned, curve=replace(learned.curve, control_points=points))
    shift = np.array([0.05, 0.02, 0.0])
    there = adapt(
        edited, learned.curve, shown, [], Target(edited.curve(0.0) + shift, edited.curve(1.0) + shift), SETTINGS
    )
    np.testing.assert_allclose(there.curve(U), edited.curve(U) + shift, atol=1e-9)


def test_one_place_is_told_and_several_give_a_spread(learned: LearnedPath, adapted: AdaptedPath) -> None:
    assert adapted.places == 1
    assert "one place only" in adapted.note
    goals = several(6, goal_spread=0.08)
    path = path_of(goals[:1])
    found = adapt(path, path.curve, goals[:1], goals[1:], to(path, np.array([0.02, 0.02, 0.0])), SETTINGS)
    assert found.places > 1
    assert found.demonstrations == 6
    assert "nineteen times of twenty" in found.note
    assert found.spread.max() > 0


def test_demonstrations_of_another_way_change_nothing(
    learned: LearnedPath, shown: list[Trajectory], adapted: AdaptedPath
) -> None:
    others = several(3, way=0) + several(3, way=2)
    found = adapt(learned, learned.curve, shown, others, to(learned), SETTINGS)
    assert found.demonstrations == len(shown)
    np.testing.assert_array_equal(found.curve.control_points, adapted.curve.control_points)


def test_many_goals_predict_a_new_one_better_than_the_straight_line() -> None:
    errors = []
    for seed in range(8):
        goals = several(6, seed=seed, goal_spread=0.08)
        path = path_of(goals[1:2])
        new = goals[0].positions
        found = adapt(path, path.curve, goals[1:2], goals[2:], Target(new[0], new[-1]), SETTINGS)
        share = np.linspace(0, 1, 200)[:, None]
        line = new[0] + share * (new[-1] - new[0])
        errors.append([_farthest(new, found.curve(np.linspace(0, 1, 400))), _farthest(new, line)])
    mine, straight = np.median(errors, axis=0)
    assert mine < 0.3 * straight


def test_orientations_begin_and_end_as_asked() -> None:
    named = synthetic.turning({str(i): each for i, each in enumerate(several(4))})
    path = learn(named, SETTINGS).paths[0]
    assert path.orientation is not None
    ends = unit_quaternions(path.orientation, np.array([0.0, 1.0]))
    asked = [(Rotation.from_rotvec(turn) * Rotation.from_quat(end, scalar_first=True)).as_quat(scalar_first=True)
             for turn, end in zip(([0.3, 0, 0.1], [0, -0.4, 0.5]), ends, strict=True)]  # fmt: skip
    target = replace(to(path), start_orientation=asked[0], goal_orientation=asked[1])
    found = adapt(path, path.curve, list(named.values()), [], target, SETTINGS)
    assert found.orientation is not None
    got = unit_quaternions(found.orientation, np.array([0.0, 1.0]))
    np.testing.assert_allclose(np.abs((got * asked).sum(axis=1)), 1.0, atol=1e-9)
    kept = adapt(path, path.curve, list(named.values()), [], to(path), SETTINGS)
    assert kept.orientation is path.orientation


def test_orientations_are_the_mean_of_all_that_were_shown_mended_at_both_ends() -> None:
    named = synthetic.turning({str(i): each for i, each in enumerate(several(6, goal_spread=0.08))})
    shown = list(named.values())
    path = learn({"0": shown[0]}, SETTINGS).paths[0]
    mean = mean_orientations(shown, 100)
    assert mean is not None
    target = replace(to(path), start_orientation=mean[0], goal_orientation=mean[-1])
    found = adapt(path, path.curve, shown[:1], shown[1:], target, replace(SETTINGS, min_separation=100.0))
    assert found.orientation is not None
    got = unit_quaternions(found.orientation, even_parameters(found.curve, STATIONS))
    assert rotation_angles(got, mean).max() < 2 * SETTINGS.turn_bound


def test_its_own_poses_leave_the_orientations_as_they_are() -> None:
    named = synthetic.turning({str(i): each for i, each in enumerate(several(4))})
    path = learn(named, SETTINGS).paths[0]
    assert path.orientation is not None
    ends = unit_quaternions(path.orientation, np.array([0.0, 1.0]))
    target = replace(to(path, np.zeros(3)), start_orientation=-ends[0], goal_orientation=ends[1])
    found = adapt(path, path.curve, list(named.values()), [], target, SETTINGS)
    assert found.orientation is path.orientation
    assert found.curve is path.curve


def test_what_one_demonstration_has_beside_the_others_is_left_behind() -> None:
    goals = several(6, goal_spread=0.08)
    path = path_of(goals[:1])
    shape = bump(path)
    odd = Trajectory(goals[0].times, goals[0].positions + shape(arc_share(goals[0].positions)))
    learned = path_of([odd])
    there = adapt(learned, learned.curve, [odd], goals[1:], to(learned), replace(SETTINGS, min_separation=100.0))
    without = adapt(path, path.curve, goals[:1], goals[1:], to(path), replace(SETTINGS, min_separation=100.0))
    height = float(np.linalg.norm(shape(np.array([0.5]))))
    assert np.linalg.norm(there.curve(0.5) - without.curve(0.5)) < 0.5 * height


def test_orientations_that_were_never_learned_are_refused(learned: LearnedPath, shown: list[Trajectory]) -> None:
    target = replace(to(learned), start_orientation=np.array([1.0, 0, 0, 0]))
    with pytest.raises(UnusableInput, match="has learned no orientations"):
        adapt(learned, learned.curve, shown, [], target, SETTINGS)


def arc_share(positions: Array) -> Array:
    s = arc_lengths(positions)
    return np.asarray(s / s[-1])


def bump(path: LearnedPath) -> Callable[[Array], Array]:
    """A detour (n, 3) [m] of 6 cm aside, by the share of the way."""
    x, y, _ = path.curve(1.0) - path.curve(0.0)
    aside = 0.06 * np.array([-y, x, 0.0]) / np.hypot(x, y)
    return lambda share: np.sin(np.pi * share)[:, None] ** 2 * aside


def _farthest(points: Array, line: Array) -> float:
    return float(np.linalg.norm(points[:, None] - line, axis=2).min(axis=1).max())
