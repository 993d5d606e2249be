"""The whole of learning: what a user sees, its laws, and every awkward set of demonstrations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import synthetic

from teachpath.errors import Cancelled, LearningFailed
from teachpath.learning.cuts import recut
from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath.nurbs import unit
from teachpath.records import Learned, Trajectory

WAYS = [{"1", "6", "8", "10", "12"}, {"2", "5", "11"}, {"3", "4", "7", "9"}]
PAPER = LearningSettings(mode="paper", threshold=0.08, repeats=0)
REPAIRED = replace(PAPER, mode="repaired")
BOTH = pytest.mark.parametrize("settings", [LearningSettings(), PAPER, REPAIRED], ids=["default", "paper", "repaired"])


def assert_usable(learned: Learned) -> None:
    """Nothing that leaves the room is NaN or infinite, and every record fits the others."""
    count = len(learned.demonstrations)
    assert learned.linkage.shape == (count - 1, 4)
    assert np.all(np.isfinite(learned.linkage))
    assert np.isfinite(learned.threshold)
    assert sorted(name for cluster in learned.clusters for name in cluster.members) == sorted(learned.demonstrations)
    assert [path.cluster for path in learned.paths] == [cluster.index for cluster in learned.clusters]
    for cluster in learned.clusters:
        assert tuple(score.demonstration for score in cluster.scores) == cluster.members
        assert [score.rank for score in cluster.scores] == list(range(1, len(cluster.members) + 1))
        assert np.all(np.isfinite([score.log_likelihood for score in cluster.scores]))
        assert np.all(np.isfinite(cluster.convergence))
        assert any(score.selected for score in cluster.scores)
        assert cluster.representative in cluster.members
        assert cluster.spread is not None
        assert np.all(np.isfinite(cluster.spread))
        for score in cluster.scores:
            assert all(np.isfinite(v) for v in (score.margin, score.z, score.stability) if v is not None)
    assert set(learned.inputs) == set(learned.demonstrations)
    for path in learned.paths:
        assert path.fit.frechet is not None
        measures = (
            path.fit.bound,
            path.fit.largest,
            path.fit.rms,
            path.fit.tube,
            path.fit.frechet,
            path.curve.length(),
        )
        assert np.all(np.isfinite(measures))
        assert len(path.curve.control_points) <= 60


def short(samples: int, seed: int = 1) -> Trajectory:
    trajectory = synthetic.demonstration(np.random.default_rng(seed), duration=(samples - 1) * synthetic.PERIOD)
    assert len(trajectory) == samples
    return trajectory


def test_three_ways_are_learned_from_the_first_experiment(learned: Learned, twelve: dict[str, Trajectory]) -> None:
    assert_usable(learned)
    assert [set(cluster.members) for cluster in learned.clusters] == WAYS
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
    assert [set(cluster.members) for cluster in learned_as_paper.clusters] == WAYS
    for cluster in learned_as_paper.clusters:
        assert sum(score.selected for score in cluster.scores) == 2
    for path in learned_as_paper.paths:
        assert ("spread too far" in path.note) == (path.fit.largest > path.fit.bound)


def test_the_result_names_its_settings_and_versions(learned: Learned) -> None:
    assert learned.settings["error_bound"] == LearningSettings().error_bound
    assert set(learned.versions) >= {"teachpath", "numpy", "scipy", "hmmlearn"}


@BOTH
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


@BOTH
def test_the_order_in_which_demonstrations_are_listed_changes_no_selection(settings: LearningSettings) -> None:
    demonstrations = synthetic.experiment_2(8)
    here, there = (
        learn(listed, replace(settings, repeats=3))
        for listed in (demonstrations, dict(reversed(demonstrations.items())))
    )
    chosen = [{s.demonstration: (s.selected, s.stability) for s in run.clusters[0].scores} for run in (here, there)]
    assert chosen[0] == chosen[1]


@pytest.mark.parametrize("metric", ["arc", "frechet", "dtw", "undersampled"])
def test_every_metric_finds_the_ways(twelve: dict[str, Trajectory], metric: str) -> None:
    learned = learn(twelve, LearningSettings(metric=metric, repeats=0))
    assert [set(cluster.members) for cluster in learned.clusters] == WAYS


def test_a_known_number_of_ways_is_found(twelve: dict[str, Trajectory]) -> None:
    learned = learn(twelve, LearningSettings(clusters=3, repeats=0))
    assert [set(cluster.members) for cluster in learned.clusters] == WAYS
    assert recut(learned, clusters=3) == recut(learned, threshold=learned.threshold)


def test_orientations_are_learned_where_all_carry_them(twelve: dict[str, Trajectory]) -> None:
    settings = LearningSettings(repeats=0)
    learned = learn(synthetic.turning(twelve), settings)
    for path, positions_only in zip(learned.paths, learn(twelve, settings).paths, strict=True):
        assert positions_only.orientation is None
        np.testing.assert_array_equal(path.curve.control_points, positions_only.curve.control_points)
        assert path.orientation is not None
        assert path.fit.turn is not None
        assert path.fit.turn <= settings.turn_bound
        turn = unit(path.orientation, np.linspace(0, 1, 200))
        assert np.all((turn[1:] * turn[:-1]).sum(axis=1) > 0.99)
        angle = 2 * np.arccos(np.abs(turn[[0, -1], 0]))
        np.testing.assert_allclose(angle, [0.0, 2.5], atol=0.03)


def test_one_demonstration_without_orientations_makes_the_path_one_of_positions() -> None:
    demonstrations = synthetic.experiment_2(1)
    turned = synthetic.turning(demonstrations)
    (path,) = learn({**turned, "2": demonstrations["2"]}, LearningSettings(repeats=0)).paths
    assert path.orientation is None
    assert path.fit.turn is None


def test_reversed_demonstrations_give_the_reversed_path() -> None:
    twelve = synthetic.experiment_1(5)
    back = {k: Trajectory(d.times, d.positions[::-1]) for k, d in twelve.items()}
    settings = LearningSettings(inconsistent=-1e6, repeats=0)  # keeps everybody, so that only geometry is compared
    for one, other in zip(learn(twelve, settings).paths, learn(back, settings).paths, strict=True):
        u = np.linspace(0, 1, 50)
        there, again = one.curve(u), other.curve(1 - u)
        assert np.linalg.norm(there - again, axis=1).max() <= 4 * one.fit.bound


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
def test_a_demanded_degree_is_used(degree: int) -> None:
    (path,) = learn(synthetic.experiment_2(1), LearningSettings(degree=degree)).paths
    assert path.curve.degree == degree


def test_a_bound_below_the_noise_is_refused_in_words() -> None:
    settings = LearningSettings(error_bound=1e-5, most_control_points=20)
    with pytest.raises(LearningFailed, match=r"raise learning\.error_bound"):
        learn(synthetic.experiment_2(1), settings)


def test_demonstrations_that_cancel_out_are_refused_in_words() -> None:
    one = synthetic.experiment_2(1)["1"]
    mirrored = Trajectory(one.times, 2 * one.positions[0] - one.positions)
    with pytest.raises(LearningFailed, match="opposite directions"):
        learn({"there": one, "away": mirrored}, LearningSettings(threshold=10.0))


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
    assert len(warned.curve.control_points) <= 12


@BOTH
def test_progress_grows_to_one_and_says_something(settings: LearningSettings) -> None:
    told: list[tuple[float, str]] = []
    learn(synthetic.experiment_2(1), settings, progress=lambda fraction, sentence: told.append((fraction, sentence)))
    fractions = [fraction for fraction, _ in told]
    assert len(told) > 5
    assert fractions == sorted(fractions)
    assert fractions[0] == 0.0
    assert fractions[-1] == 1.0
    assert all(sentence for _, sentence in told)


@BOTH
@pytest.mark.parametrize("after", [0.0, 0.1, 0.5, 0.8])
def test_cancelling_at_any_stage_passes_through(settings: LearningSettings, after: float) -> None:
    def cancel(fraction: float, _sentence: str) -> None:
        if fraction >= after:
            raise Cancelled("enough")

    with pytest.raises(Cancelled):
        learn(synthetic.experiment_2(1), settings, progress=cancel)


@BOTH
def test_one_demonstration_gives_one_path_along_it(settings: LearningSettings) -> None:
    one = synthetic.experiment_2(1)["1"]
    learned = learn({"only": one}, settings)
    assert_usable(learned)
    assert learned.clusters[0].scores[0].selected
    assert learned.clusters[0].note
    np.testing.assert_allclose(learned.paths[0].curve(0.0), one.positions[0], atol=1e-12)


@BOTH
@pytest.mark.parametrize("count", [2, 3])
def test_few_demonstrations_give_one_path(settings: LearningSettings, count: int) -> None:
    learned = learn(synthetic.experiment_2(1, count=count), settings)
    assert_usable(learned)
    assert len(learned.paths) == 1


@BOTH
@pytest.mark.parametrize("count", [2, 3, 6])
def test_identical_demonstrations_give_one_path(settings: LearningSettings, count: int) -> None:
    one = synthetic.experiment_2(1)["1"]
    learned = learn({str(i): one for i in range(count)}, settings)
    assert_usable(learned)
    assert len(learned.paths) == 1
    assert learned.linkage[:, 2].max() == 0.0


@BOTH
@pytest.mark.parametrize("samples", [5, 8, 12, 19, 20, 21, 39, 40])
def test_demonstrations_around_the_analysis_window_are_learned(settings: LearningSettings, samples: int) -> None:
    assert_usable(learn({str(i): short(samples, i) for i in range(4)}, settings))


@BOTH
def test_wildly_different_lengths_are_learned(settings: LearningSettings) -> None:
    demonstrations = {str(i): short(samples, i) for i, samples in enumerate([25, 160, 1500, 400])}
    learned = learn(demonstrations, settings)
    assert_usable(learned)
    if settings.mode == "default":
        assert len(learned.paths) == 1


@BOTH
def test_an_empty_set_is_refused(settings: LearningSettings) -> None:
    with pytest.raises(LearningFailed, match="no demonstration"):
        learn({}, settings)


def spoilt(kind: str) -> Trajectory:
    good = synthetic.experiment_2(1)["1"]
    positions, times = good.positions.copy(), good.times.copy()
    match kind:
        case "nan":
            positions[77, 1] = np.nan
        case "infinite time":
            times[77] = np.inf
        case "backwards":
            times[77] = times[75]
        case "few":
            return Trajectory(times[:4], positions[:4])
        case "repeated":
            positions[:] = positions[np.arange(len(positions)) // 60]
        case "still":
            positions[:] = positions[0]
        case "trembling":
            positions = positions[0] + 1e-4 * np.random.default_rng(1).normal(size=positions.shape)
        case "flat":
            positions = positions[:, :2]
        case "empty":
            return Trajectory(np.empty(0), np.empty((0, 3)))
    return replace(good, times=times, positions=positions)


@BOTH
@pytest.mark.parametrize(
    ("kind", "sentence"),
    [
        ("nan", "sample 77"),
        ("infinite time", "sample 77"),
        ("backwards", "forward in time"),
        ("few", "4 distinct points"),
        ("repeated", "4 distinct points"),
        ("still", "1 distinct points"),
        ("trembling", "moves only"),
        ("flat", "shape"),
        ("empty", "0 distinct points"),
    ],
)
def test_an_unusable_demonstration_is_named(settings: LearningSettings, kind: str, sentence: str) -> None:
    with pytest.raises(LearningFailed, match=rf"take-7 .*{sentence}"):
        learn({**synthetic.experiment_2(1), "take-7": spoilt(kind)}, settings)
