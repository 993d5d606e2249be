"""Who is found inconsistent, wherever it stands in the list; and that nobody is when nobody is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from teachpath.learning.selection.default_mode import select, step_count
from teachpath.learning.settings import LearningSettings
from teachpath.records import Array, Cluster, Trajectory
from tests.unit.learning import synthetic

SETTINGS = LearningSettings(repeats=0)


def selected(demonstrations: dict[str, Trajectory], settings: LearningSettings = SETTINGS) -> Cluster:
    return select(1, demonstrations, settings, on_step=lambda: None)


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


@pytest.mark.parametrize("seed", range(5))
def test_two_that_shake_do_not_excuse_each_other(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shaking = rng.permutation(5)[:2]
    five = {str(i): synthetic.demonstration(rng, wiggle=0.025 * (i in shaking)) for i in range(5)}
    assert kept(selected(five)).isdisjoint(map(str, shaking))


def paused(positions: Array, rng: np.random.Generator) -> Array:
    still = np.repeat(positions[100:101], 40, axis=0) + rng.normal(0, 0.001, (40, 3))
    return np.concatenate([positions[:100], still, positions[100:]])


def frozen(positions: Array, _rng: np.random.Generator) -> Array:
    positions[100:115] = positions[100]
    return positions


def spiked(positions: Array, _rng: np.random.Generator) -> Array:
    positions[105, 1] += 0.08
    return positions


def detoured(positions: Array, rng: np.random.Generator) -> Array:
    side = rng.normal(size=3)
    bump = np.exp(-0.5 * np.square((np.linspace(0, 1, len(positions)) - 0.5) / 0.09))
    return np.asarray(positions + 0.06 * bump[:, None] * side / np.linalg.norm(side))


def jittered(positions: Array, rng: np.random.Generator) -> Array:
    return np.asarray(positions + rng.normal(0, 0.004, positions.shape))


def spoilt(seed: int, fault: Callable[[Array, np.random.Generator], Array]) -> dict[str, Trajectory]:
    """Five of one way, the third with a fault in its middle."""
    demonstrations = synthetic.experiment_2(seed, wiggle=0.0)
    positions = fault(demonstrations["3"].positions.copy(), np.random.default_rng(seed))
    return {**demonstrations, "3": Trajectory(np.arange(len(positions)) * synthetic.PERIOD, positions)}


@pytest.mark.parametrize(
    ("fault", "words", "least"),
    [
        (paused, "stands still for 0.", 4),
        (frozen, "the tracker repeats one reading for 0.28 s", 4),
        (spiked, "jumps by", 4),
        (jittered, "times a second", 4),
        (detoured, "beside the others", 4),
    ],
)
def test_every_fault_is_outside_the_best_two_and_told_with_its_place(
    fault: Callable[[Array, np.random.Generator], Array], words: str, least: int
) -> None:
    clusters = [selected(spoilt(seed, fault)) for seed in range(4)]
    assert all("3" in cluster.members[2:] for cluster in clusters)
    last = [cluster.scores[-1] for cluster in clusters if cluster.members[-1] == "3"]
    assert sum(not score.selected for score in last) >= least
    told = [score.deviation for score in last if score.deviation is not None]
    assert told
    for departure in told:
        assert words in departure.sentence
        begin, end = departure.share
        assert 0 <= begin < end <= 1
        assert departure.seconds[0] < 2.3
        assert departure.seconds[1] > 2.0


def test_the_span_lies_around_the_fault() -> None:
    departure = selected(spoilt(7, frozen)).scores[-1].deviation  # frozen from 2.0 to 2.3 s
    assert departure is not None
    begin, end = departure.seconds
    assert begin == pytest.approx(2.0)
    assert end == pytest.approx(2.28)
    assert 0.4 < departure.share[0] < departure.share[1] < 0.7


def test_consistent_demonstrations_have_no_departure_and_a_score_of_nearly_nought() -> None:
    cluster = selected(synthetic.experiment_2(11))
    for score in cluster.scores[:2]:
        assert score.deviation is None
        assert score.z is not None
        assert -1.0 < score.z <= 0.0
    margins = [score.margin for score in cluster.scores]
    assert margins[-1] is None
    assert all(margin is not None and margin >= 0 for margin in margins[:-1])


@pytest.mark.parametrize("repeats", [0, 3, 20])
def test_stability_is_the_share_of_repetitions_in_which_it_is_selected(repeats: int) -> None:
    cluster = selected(synthetic.experiment_2(12), replace(SETTINGS, repeats=repeats))
    stabilities = [score.stability for score in cluster.scores]
    if repeats == 0:
        assert set(stabilities) == {None}
    else:
        assert stabilities[-1] == 0.0  # the wiggly one never is
        assert stabilities[0] == 1.0


def test_repetitions_change_nothing_but_the_stability() -> None:
    demonstrations = synthetic.experiment_2(13)
    once, often = (selected(demonstrations, replace(SETTINGS, repeats=repeats)) for repeats in (0, 5))
    assert once.scores == tuple(replace(score, stability=None) for score in often.scores)


@pytest.fixture(scope="module")
def without_wiggle() -> list[Cluster]:
    return [selected(synthetic.experiment_2(seed, wiggle=0.0)) for seed in range(30)]


def test_without_wiggle_the_marked_one_is_treated_like_the_others(without_wiggle: list[Cluster]) -> None:
    rejected = np.mean([cluster.members.index("5") >= 2 for cluster in without_wiggle])  # keep 2 of 5: chance is 0.6
    assert abs(rejected - 0.6) <= 3 * np.sqrt(0.6 * 0.4 / len(without_wiggle))


def test_consistent_demonstrations_are_seldom_called_inconsistent(without_wiggle: list[Cluster]) -> None:
    flagged = np.mean([1 - len(kept(cluster)) / 5 for cluster in without_wiggle])
    assert flagged <= 0.02


def test_in_clusters_of_three_false_alarms_are_rare_too() -> None:
    clusters = [selected(synthetic.experiment_2(seed, wiggle=0.0, count=3)) for seed in range(30)]
    assert np.mean([1 - len(kept(cluster)) / 3 for cluster in clusters]) <= 0.04


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
    cluster = selected(synthetic.experiment_2(4), LearningSettings(keep=keep, outlier_limit=1e-6, repeats=0))
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


@pytest.mark.parametrize("duration", [0.06, 0.3])
def test_short_demonstrations_are_judged_like_any_other(duration: float) -> None:
    rng = np.random.default_rng(5)
    cluster = selected({str(i): synthetic.demonstration(rng, duration=duration) for i in range(5)})
    assert np.all(np.isfinite([(score.log_likelihood, score.z) for score in cluster.scores]))


@pytest.mark.parametrize("pace", [0.5, 2.0])
def test_pace_alone_leaves_nobody_out_and_is_told_as_what_it_is(pace: float) -> None:
    for seed in range(4):
        five = synthetic.experiment_2(seed, wiggle=0.0)
        slow = five["3"]
        cluster = selected({**five, "3": Trajectory(slow.times / pace, slow.positions)})
        (score,) = [score for score in cluster.scores if score.demonstration == "3"]
        assert score.selected
        assert score.deviation is not None
        assert f"2.0 times as {'fast' if pace > 1 else 'slowly'}" in score.deviation.sentence


@pytest.mark.parametrize("rate", [25, 100, 200])
def test_the_sampling_rate_of_one_tells_nothing(rate: int) -> None:
    rng = np.random.default_rng(rate)
    five = {str(i): synthetic.demonstration(rng, duration=3.98, noise=0.0) for i in range(5)}
    times = np.arange(0.0, 3.98, 1 / rate)
    columns = [np.interp(times, five["2"].times, five["2"].positions[:, k]) for k in range(3)]
    noisy = {k: Trajectory(d.times, d.positions + rng.normal(0, 0.001, d.positions.shape)) for k, d in five.items()}
    noisy["2"] = Trajectory(times, np.column_stack(columns) + rng.normal(0, 0.001, (len(times), 3)))
    assert "2" in kept(selected(noisy))


def test_the_size_of_the_task_changes_no_decision() -> None:
    here = selected(spoilt(2, paused), LearningSettings(error_bound=100.0, repeats=0))
    for factor in (0.07, 7.0):
        moved = {k: Trajectory(d.times, factor * d.positions) for k, d in spoilt(2, paused).items()}
        there = selected(moved, LearningSettings(error_bound=100.0, repeats=0))
        np.testing.assert_allclose([s.z for s in there.scores], [s.z for s in here.scores], atol=1e-6)
        assert kept(there) == kept(here)


def test_a_detour_is_left_out_wherever_it_leads() -> None:
    found = ["3" not in kept(selected(spoilt(seed, detoured))) for seed in range(100, 125)]
    assert sum(found) >= 23


@pytest.mark.parametrize("fault", [detoured, spiked, jittered])
def test_a_mirrored_reversed_or_sparser_recording_changes_no_decision(
    fault: Callable[[Array, np.random.Generator], Array],
) -> None:
    shown = spoilt(2, fault)
    for changed in (
        {k: Trajectory(d.times, d.positions * [-1.0, 1.0, 1.0]) for k, d in shown.items()},
        {k: Trajectory(d.times, d.positions[::-1]) for k, d in shown.items()},
        {k: Trajectory(d.times[1::2], d.positions[1::2]) for k, d in shown.items()},
    ):
        assert kept(selected(changed)) == kept(selected(shown))


def test_nobody_shakes_below_the_bound_of_the_fit() -> None:
    rng = np.random.default_rng(3)
    still = {str(i): synthetic.demonstration(rng, tremor=0.0, noise=1e-5) for i in range(4)}
    cluster = selected({**still, "9": synthetic.demonstration(rng, tremor=0.0, noise=1e-5, wiggle=0.002)})
    (score,) = [score for score in cluster.scores if score.demonstration == "9"]
    assert "shakes" not in score.note
    closer = selected(
        {**still, "9": synthetic.demonstration(rng, tremor=0.0, noise=1e-5, wiggle=0.002)},
        replace(SETTINGS, error_bound=0.0005),
    )
    assert "9" not in kept(closer)


def test_a_note_says_what_leaving_one_out_costs() -> None:
    note = selected(synthetic.experiment_2(11)).scores[-1].note
    assert "without it the path moves by up to" in note
    assert " 0 mm" not in note


def test_many_demonstrations_are_judged_in_folds() -> None:
    rng = np.random.default_rng(6)
    crowd = {f"{i:02}": synthetic.demonstration(rng, wiggle=0.025 * (i == 17)) for i in range(33)}
    ticks: list[int] = []
    cluster = select(1, crowd, SETTINGS, on_step=lambda: ticks.append(1))
    assert cluster.members[-1] == "17"
    assert len(ticks) == step_count([33]) < step_count([30])
