"""The whole of learning: what a user sees of it."""

from __future__ import annotations

import numpy as np
import pytest

from teachpath.errors import Cancelled, LearningFailed
from teachpath.learning.clustering.cuts import recut_members
from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath.nurbs import unit_quaternions
from teachpath.records import Learned, Trajectory
from tests.unit.learning import synthetic
from tests.unit.learning.usable import IN_EVERY_MODE, PAPER, PAPER_CLUSTERS, assert_usable


def test_three_ways_are_learned_from_the_first_experiment(learned: Learned, twelve: dict[str, Trajectory]) -> None:
    assert_usable(learned)
    assert [set(cluster.members) for cluster in learned.clusters] == PAPER_CLUSTERS
    for cluster, path in zip(learned.clusters, learned.paths, strict=True):
        assert path.fit.largest <= path.fit.bound == LearningSettings().error_bound
        chosen = [twelve[score.demonstration].positions for score in cluster.scores if score.selected]
        ends = path.curve(np.array([0.0, 1.0]))
        np.testing.assert_allclose(ends[0], np.mean([p[0] for p in chosen], axis=0), atol=1e-12)
        np.testing.assert_allclose(ends[1], np.mean([p[-1] for p in chosen], axis=0), atol=1e-12)
        u = np.linspace(0, 1, 4001)
        dense = path.curve(u)
        tube = max(np.linalg.norm(dense - point, axis=1).min() for p in chosen for point in p[::5])
        assert tube <= path.fit.tube + 1e-4
        assert cluster.convergence[-1] > cluster.convergence[0]
        assert cluster.spread is not None
        assert 0 < cluster.spread.max() <= path.fit.tube + 0.01
        assert cluster.ambiguous == ""


def test_mode_paper_finds_the_ways_and_keeps_two_of_each(learned_as_paper: Learned) -> None:
    assert_usable(learned_as_paper)
    assert [set(cluster.members) for cluster in learned_as_paper.clusters] == PAPER_CLUSTERS
    for cluster in learned_as_paper.clusters:
        assert sum(score.selected for score in cluster.scores) == 2
    for path in learned_as_paper.paths:
        assert path.fit.largest <= path.fit.bound
        assert ("zigzag" in path.note) == (path.fit.bound > learned_as_paper.settings["error_bound"])


def test_the_result_names_its_settings_and_versions(learned: Learned) -> None:
    assert learned.settings["error_bound"] == LearningSettings().error_bound
    assert set(learned.versions) >= {"teachpath", "numpy", "scipy", "hmmlearn"}


@pytest.mark.parametrize("metric", ["arc", "frechet", "dtw", "undersampled"])
def test_every_metric_finds_the_ways(twelve: dict[str, Trajectory], metric: str) -> None:
    learned = learn(twelve, LearningSettings(metric=metric, repeats=0))
    assert [set(cluster.members) for cluster in learned.clusters] == PAPER_CLUSTERS


def test_a_known_number_of_ways_is_found(twelve: dict[str, Trajectory]) -> None:
    learned = learn(twelve, LearningSettings(clusters=3, repeats=0))
    assert [set(cluster.members) for cluster in learned.clusters] == PAPER_CLUSTERS
    assert recut_members(learned, clusters=3) == recut_members(learned, threshold=learned.threshold)


def test_orientations_are_learned_where_all_carry_them(twelve: dict[str, Trajectory]) -> None:
    settings = LearningSettings(repeats=0)
    learned = learn(synthetic.turning(twelve), settings)
    for path, positions_only in zip(learned.paths, learn(twelve, settings).paths, strict=True):
        assert positions_only.orientation is None
        np.testing.assert_array_equal(path.curve.control_points, positions_only.curve.control_points)
        assert path.orientation is not None
        assert path.fit.turn is not None
        assert path.fit.turn <= settings.turn_bound
        turn = unit_quaternions(path.orientation, np.linspace(0, 1, 200))
        assert np.all((turn[1:] * turn[:-1]).sum(axis=1) > 0.99)
        angle = 2 * np.arccos(np.abs(turn[[0, -1], 0]))
        np.testing.assert_allclose(angle, [0.0, 2.5], atol=0.03)


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
def test_a_demanded_degree_is_used(degree: int) -> None:
    (path,) = learn(synthetic.experiment_2(1), LearningSettings(degree=degree)).paths
    assert path.curve.degree == degree


def test_a_bound_below_the_noise_is_refused_in_words() -> None:
    settings = LearningSettings(error_bound=1e-5, most_control_points=20)
    with pytest.raises(LearningFailed, match=r"raise learning\.error_bound"):
        learn(synthetic.experiment_2(1), settings)


def test_a_motion_that_comes_back_to_the_start_is_followed_and_mode_paper_warns() -> None:
    t = np.linspace(0, 1, 160)
    circle = np.column_stack([0.2 - 0.2 * np.cos(2 * np.pi * t), 0.2 * np.sin(2 * np.pi * t), 0 * t])
    rng = np.random.default_rng(1)
    round_trips = {k: Trajectory(t * 3.2, circle + rng.normal(0, 0.001, circle.shape)) for k in "abc"}
    (path,) = learn(round_trips, LearningSettings()).paths
    at = path.curve(np.linspace(0, 1, 400))
    assert max(np.linalg.norm(at - point, axis=1).min() for point in circle) < 0.008
    (warned,) = learn(round_trips, PAPER).paths
    assert "back towards the start" in warned.note
    assert warned.fit.largest <= warned.fit.bound


@IN_EVERY_MODE
def test_progress_grows_to_one_and_says_something(settings: LearningSettings) -> None:
    told: list[tuple[float, str]] = []
    learn(synthetic.experiment_2(1), settings, progress=lambda fraction, sentence: told.append((fraction, sentence)))
    fractions = [fraction for fraction, _ in told]
    assert len(told) > 5
    assert fractions == sorted(fractions)
    assert fractions[0] == 0.0
    assert fractions[-1] == 1.0
    assert all(sentence for _, sentence in told)


@IN_EVERY_MODE
@pytest.mark.parametrize("after", [0.0, 0.1, 0.5, 0.8])
def test_cancelling_at_any_stage_passes_through(settings: LearningSettings, after: float) -> None:
    def cancel(fraction: float, _sentence: str) -> None:
        if fraction >= after:
            raise Cancelled("enough")

    with pytest.raises(Cancelled):
        learn(synthetic.experiment_2(1), settings, progress=cancel)
