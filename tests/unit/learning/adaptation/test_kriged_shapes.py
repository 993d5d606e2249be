"""Predicted paths: exact ends, the mean where nothing differs, the shown shape wherever the task is moved or turned."""

from __future__ import annotations

import numpy as np
import pytest

from teachpath.learning.adaptation.kriged_shapes import KrigedShapes
from teachpath.records import Array

SHARE = np.linspace(0.0, 1.0, 100)[:, None]
START, GOAL = np.array([0.4, -0.3, 0.5]), np.array([0.45, 0.3, 0.52])


def bow(start: Array, goal: Array, height: float = 0.2, aside: float = 0.0) -> Array:
    """A path that rises, and leaves the line from start to goal to its left: (100, 3) [m]."""
    chord = goal - start
    left = np.array([-chord[1], chord[0], 0.0]) / np.hypot(chord[0], chord[1])
    arch = np.sin(np.pi * SHARE)
    return np.asarray(start + SHARE * chord + arch * (height * np.array([0.0, 0.0, 1.0]) + aside * left))


def places(seed: int, count: int) -> list[tuple[Array, Array]]:
    rng = np.random.default_rng(seed)
    return [(START + rng.normal(0, 0.05, 3), GOAL + rng.normal(0, 0.05, 3)) for _ in range(count)]


def rotated(angle: float) -> Array:
    return np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1.0]])


@pytest.mark.parametrize("count", [1, 2, 5])
def test_a_predicted_path_begins_and_ends_where_it_is_asked_to(count: int) -> None:
    shapes = KrigedShapes(np.array([bow(*ends) for ends in places(1, count)]))
    for start, goal in places(2, 20):
        path = shapes.predict(start, goal).path
        np.testing.assert_allclose(path[[0, -1]], [start, goal], atol=1e-12)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_between_equal_ends_the_prediction_is_the_mean(count: int) -> None:
    shown = np.array([bow(START, GOAL, 0.15 + 0.02 * i, 0.01 * i) for i in range(count)])
    np.testing.assert_allclose(KrigedShapes(shown).predict(START, GOAL).path, shown.mean(axis=0), atol=1e-12)


def test_a_moved_task_is_predicted_by_the_moved_path() -> None:
    shown = np.array([bow(*ends, 0.2, 0.1) for ends in places(3, 4)])
    shift = np.array([0.1, -0.2, 0.05])
    here, there = KrigedShapes(shown).predict(START, GOAL), KrigedShapes(shown).predict(START + shift, GOAL + shift)
    np.testing.assert_allclose(there.path, here.path + shift, atol=1e-12)
    np.testing.assert_allclose(there.deviation, here.deviation, atol=1e-12)


def test_demonstrations_and_ends_turned_together_turn_the_prediction() -> None:
    shown = np.array([bow(*ends, 0.2, 0.1) for ends in places(4, 4)])
    turn = rotated(0.8)
    here = KrigedShapes(shown).predict(START, GOAL)
    there = KrigedShapes(shown @ turn.T).predict(turn @ START, turn @ GOAL)
    np.testing.assert_allclose(there.path, here.path @ turn.T, atol=1e-12)


def test_the_height_between_is_kept_however_the_task_is_turned() -> None:
    shown = np.array([bow(*ends, 0.2) for ends in places(5, 4)])
    for angle in (0.5, 1.5, 3.0):
        goal = START + rotated(angle) @ (GOAL - START)
        path = KrigedShapes(shown).predict(START, goal).path
        np.testing.assert_allclose(path[:, 2], KrigedShapes(shown).predict(START, GOAL).path[:, 2], atol=0.01)


def test_the_nearer_demonstration_counts_more() -> None:
    turned = START + rotated(1.2) @ (GOAL - START)
    shapes = KrigedShapes(np.array([bow(START, GOAL, 0.1), bow(START, turned, 0.3)]))
    assert shapes.predict(START, GOAL).path[50, 2] < shapes.predict(START, turned).path[50, 2]


def test_a_closed_path_is_moved_only() -> None:
    angle = 2 * np.pi * SHARE[:, 0]
    closed = START + np.column_stack([0.2 - 0.2 * np.cos(angle), 0.15 * np.sin(angle), 0 * angle])
    there = KrigedShapes(closed[None]).predict(GOAL, GOAL)
    np.testing.assert_allclose(there.path, closed + GOAL - START, atol=1e-12)
    assert there.extrapolates == ""
    ahead = START + np.array([0.4, 0.0, 0.0])
    assert "otherwise than shown" in KrigedShapes(closed[None]).predict(START, ahead).extrapolates


def test_it_says_when_it_extrapolates() -> None:
    shapes = KrigedShapes(np.array([bow(*ends) for ends in places(6, 5)]))
    assert shapes.predict(START, GOAL).extrapolates == ""
    assert "apart on the level, shown were" in shapes.predict(START, START + 2.5 * (GOAL - START)).extrapolates
    higher = shapes.predict(START, GOAL + np.array([0, 0, 0.4])).extrapolates
    assert higher.startswith("the goal is 42 cm higher than the start, shown were")
    assert "°" in shapes.predict(START, START + rotated(2.0) @ (GOAL - START)).extrapolates


def test_two_deviations_hold_most_of_new_demonstrations_and_are_zero_at_the_ends() -> None:
    rng = np.random.default_rng(7)
    held = []
    for seed in range(60):
        shown = np.array([bow(*ends, *rng.normal([0.2, 0.0], 0.02)) for ends in places(seed, 6)])
        found = KrigedShapes(shown[1:]).predict(shown[0, 0], shown[0, -1])
        off = np.linalg.norm(found.path - shown[0], axis=1)
        held.append(np.sqrt(np.mean(off**2)) < 2 * np.sqrt(np.mean(found.deviation**2)))
        np.testing.assert_allclose(found.deviation[[0, -1]], 0.0, atol=1e-9)
    assert np.mean(held) > 0.8
