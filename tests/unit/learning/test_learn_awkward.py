"""Awkward sets of demonstrations: few, alike, short, uneven, unusable."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import LearningFailed
from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath.records import Trajectory
from tests.unit.learning import synthetic
from tests.unit.learning.usable import IN_EVERY_MODE, assert_usable


def short(samples: int, seed: int = 1) -> Trajectory:
    trajectory = synthetic.demonstration(np.random.default_rng(seed), duration=(samples - 1) * synthetic.PERIOD)
    assert len(trajectory) == samples
    return trajectory


def test_one_demonstration_without_orientations_makes_the_path_one_of_positions() -> None:
    demonstrations = synthetic.experiment_2(1)
    turned = synthetic.turning(demonstrations)
    (path,) = learn({**turned, "2": demonstrations["2"]}, LearningSettings(repeats=0)).paths
    assert path.orientation is None
    assert path.fit.turn is None


def test_demonstrations_that_cancel_out_are_refused_in_words() -> None:
    one = synthetic.experiment_2(1)["1"]
    mirrored = Trajectory(one.times, 2 * one.positions[0] - one.positions)
    with pytest.raises(LearningFailed, match="opposite directions"):
        learn({"there": one, "away": mirrored}, LearningSettings(threshold=10.0))


@IN_EVERY_MODE
def test_one_demonstration_gives_one_path_along_it(settings: LearningSettings) -> None:
    one = synthetic.experiment_2(1)["1"]
    learned = learn({"only": one}, settings)
    assert_usable(learned)
    assert learned.clusters[0].scores[0].selected
    assert learned.clusters[0].note
    np.testing.assert_allclose(learned.paths[0].curve(0.0), one.positions[0], atol=1e-12)


@IN_EVERY_MODE
@pytest.mark.parametrize("count", [2, 3])
def test_few_demonstrations_give_one_path(settings: LearningSettings, count: int) -> None:
    learned = learn(synthetic.experiment_2(1, count=count), settings)
    assert_usable(learned)
    assert len(learned.paths) == 1


@IN_EVERY_MODE
@pytest.mark.parametrize("count", [2, 3, 6])
def test_identical_demonstrations_give_one_path(settings: LearningSettings, count: int) -> None:
    one = synthetic.experiment_2(1)["1"]
    learned = learn({str(i): one for i in range(count)}, settings)
    assert_usable(learned)
    assert len(learned.paths) == 1
    assert learned.linkage[:, 2].max() == 0.0


@IN_EVERY_MODE
@pytest.mark.parametrize("samples", [5, 8, 12, 19, 20, 21, 39, 40])
def test_demonstrations_around_the_analysis_window_are_learned(settings: LearningSettings, samples: int) -> None:
    assert_usable(learn({str(i): short(samples, i) for i in range(4)}, settings))


@IN_EVERY_MODE
def test_wildly_different_lengths_are_learned(settings: LearningSettings) -> None:
    demonstrations = {str(i): short(samples, i) for i, samples in enumerate([25, 160, 1500, 400])}
    learned = learn(demonstrations, settings)
    assert_usable(learned)
    if settings.mode == "default":
        assert len(learned.paths) == 1


@IN_EVERY_MODE
def test_an_empty_set_is_refused(settings: LearningSettings) -> None:
    with pytest.raises(LearningFailed, match="no demonstration") as refused:
        learn({}, settings)
    assert refused.value.demonstration == ""


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


@IN_EVERY_MODE
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
    still = kind in ("still", "trembling") and settings.mode == "default"  # which is refused alone only
    shown = {**({} if still else synthetic.experiment_2(1)), "take-7": spoilt(kind)}
    with pytest.raises(LearningFailed, match=rf"take-7 .*{sentence}") as refused:
        learn(shown, settings)
    assert refused.value.demonstration == "take-7"


@pytest.mark.parametrize("kind", ["still", "trembling"])
def test_one_that_does_not_move_is_left_out_and_told(kind: str) -> None:
    five = synthetic.experiment_2(1)
    learned = learn({**five, "take-7": spoilt(kind)}, LearningSettings(repeats=0))
    assert learned.demonstrations == tuple(five)
    assert any(note.startswith("demonstration take-7") and "left out" in note for note in learned.notes)
    np.testing.assert_array_equal(
        learned.paths[0].curve.control_points, learn(five, LearningSettings(repeats=0)).paths[0].curve.control_points
    )
