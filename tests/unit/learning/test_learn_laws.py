"""The laws of learning: what must not change it, and what must change with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath.records import Learned, Trajectory
from tests.unit.learning import synthetic
from tests.unit.learning.usable import IN_EVERY_MODE


@IN_EVERY_MODE
def test_the_same_input_gives_the_same_bits(settings: LearningSettings) -> None:
    first, second = (learn(synthetic.experiment_1(2), settings) for _ in range(2))
    np.testing.assert_array_equal(first.linkage, second.linkage)
    for one, other in zip(first.clusters, second.clusters, strict=True):
        assert one.scores == other.scores
        assert one.convergence == other.convergence
    for a, b in zip(first.paths, second.paths, strict=True):
        np.testing.assert_array_equal(a.curve.control_points, b.curve.control_points)
        np.testing.assert_array_equal(a.curve.knots, b.curve.knots)
        assert a.fit == b.fit


def test_the_order_of_demonstrations_does_not_matter(learned: Learned, twelve: dict[str, Trajectory]) -> None:
    names = list(twelve)
    order = np.random.default_rng(3).permutation(12)
    shuffled = learn({names[i]: twelve[names[i]] for i in order}, LearningSettings())
    paths = {cluster.members: path for cluster, path in zip(learned.clusters, learned.paths, strict=True)}
    for cluster, path in zip(shuffled.clusters, shuffled.paths, strict=True):
        np.testing.assert_allclose(path.curve.control_points, paths[cluster.members].curve.control_points, atol=1e-9)


def test_a_rigid_motion_of_the_demonstrations_moves_the_paths(learned: Learned, twelve: dict[str, Trajectory]) -> None:
    rotation = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    offset = np.array([0.4, -1.0, 0.3])
    there = learn(synthetic.moved(twelve, rotation, offset), LearningSettings())
    for here, moved in zip(learned.paths, there.paths, strict=True):
        expected = here.curve.control_points @ rotation.T + offset
        np.testing.assert_allclose(moved.curve.control_points, expected, atol=1e-6)


@pytest.mark.parametrize("order", [(1, 2, 0), (1, 0, 2)])
def test_a_permutation_of_the_axes_permutes_the_paths(
    learned: Learned, twelve: dict[str, Trajectory], order: tuple[int, ...]
) -> None:
    there = learn(synthetic.moved(twelve, np.eye(3)[list(order)], np.zeros(3)), LearningSettings())
    for here, permuted in zip(learned.paths, there.paths, strict=True):
        np.testing.assert_allclose(permuted.curve.control_points, here.curve.control_points[:, list(order)], atol=1e-6)


@pytest.mark.parametrize("scale", [0.5, 3.0])
def test_a_scaled_task_with_a_scaled_bound_has_scaled_paths(
    learned: Learned, twelve: dict[str, Trajectory], scale: float
) -> None:
    there = learn(synthetic.moved(twelve, scale * np.eye(3), np.zeros(3)), LearningSettings(error_bound=0.005 * scale))
    assert there.threshold == pytest.approx(scale * learned.threshold)
    for one, other in zip(learned.clusters, there.clusters, strict=True):
        assert set(other.members) == set(one.members)
        assert other.representative == one.representative
    for here, scaled in zip(learned.paths, there.paths, strict=True):
        np.testing.assert_allclose(scaled.curve.control_points, scale * here.curve.control_points, atol=1e-6)


def test_times_in_another_clock_give_the_same_paths(learned: Learned, twelve: dict[str, Trajectory]) -> None:
    later = {k: Trajectory(d.times + 1000.0, d.positions) for k, d in twelve.items()}
    for here, there in zip(learned.paths, learn(later, LearningSettings()).paths, strict=True):
        np.testing.assert_allclose(there.curve.control_points, here.curve.control_points, atol=1e-6)


@IN_EVERY_MODE
def test_the_order_in_which_demonstrations_are_listed_changes_no_selection(settings: LearningSettings) -> None:
    demonstrations = synthetic.experiment_2(8)
    here, there = (
        learn(listed, replace(settings, repeats=3))
        for listed in (demonstrations, dict(reversed(demonstrations.items())))
    )
    chosen = [{s.demonstration: (s.selected, s.stability) for s in run.clusters[0].scores} for run in (here, there)]
    assert chosen[0] == chosen[1]


def test_reversed_demonstrations_give_the_reversed_path() -> None:
    twelve = synthetic.experiment_1(5)
    back = {k: Trajectory(d.times, d.positions[::-1]) for k, d in twelve.items()}
    settings = LearningSettings(outlier_limit=1e6, repeats=0)  # keeps everybody, so that only geometry is compared
    for one, other in zip(learn(twelve, settings).paths, learn(back, settings).paths, strict=True):
        u = np.linspace(0, 1, 50)
        there, again = one.curve(u), other.curve(1 - u)
        assert np.linalg.norm(there - again, axis=1).max() <= 4 * one.fit.bound
