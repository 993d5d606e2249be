"""The path of one cluster stays with the mean clean path, loops and retreats or not."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from teachpath.errors import LearningFailed
from teachpath.learning.fitting import synthesis
from teachpath.learning.fitting.synthesis import residual_noise
from teachpath.learning.matching import frechet_distance
from teachpath.learning.resampling import at_equal_arc_length, extent
from teachpath.learning.settings import LearningSettings
from teachpath.records import Array, LearnedPath, Trajectory
from tests.unit.learning import synthetic

KINDS = {"loop": synthetic.curl(), "retreat": synthetic.retreat(), "closed": synthetic.closed()}
PAPER = LearningSettings(mode="paper", threshold=0.1)


def synthesise(trajectories: list[Trajectory], **settings: float) -> LearnedPath:
    return synthesis.fit_mean_path(1, trajectories, LearningSettings(**settings), on_step=lambda: None)  # type: ignore[arg-type]


def off(path: LearnedPath, clean: Array) -> float:
    """Fréchet distance from the mean clean path, ends and order included."""
    return frechet_distance(at_equal_arc_length(path.curve(np.linspace(0, 1, 2000)), 300), clean)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [2, 5])
@pytest.mark.parametrize("seed", range(3))
def test_the_path_is_within_a_centimetre_of_the_mean_clean_path(kind: str, count: int, seed: int) -> None:
    trajectories, clean = synthetic.shown(KINDS[kind], count, seed)
    path = synthesise(trajectories)
    assert off(path, clean) <= 0.01
    assert path.fit.largest <= path.fit.bound
    assert path.fit.frechet is not None
    assert path.fit.frechet >= path.fit.largest - 0.002
    assert path.note == ""


@pytest.mark.parametrize("kind", KINDS)
def test_mode_paper_scrambles_such_paths_and_says_so(kind: str) -> None:
    trajectories, clean = synthetic.shown(KINDS[kind], 2)
    path = synthesis.fit_pooled_points(1, trajectories, PAPER, on_step=lambda: None)
    assert "back towards the start" in path.note
    assert off(path, clean) > 0.02
    assert path.fit.frechet is not None
    assert path.fit.frechet > 0.02


def test_a_bound_below_the_noise_names_the_noise() -> None:
    trajectories, _ = synthetic.shown(synthetic.loop(), 2)
    with pytest.raises(
        LearningFailed, match=r"within 0\.02 mm: noise leaves some 0\.\d+ mm .* raise learning.error_bound to"
    ):
        synthesise(trajectories, error_bound=2e-5, most_control_points=40)


def test_a_wiggly_mean_is_followed_as_closely_as_can_be_and_the_note_says_how() -> None:
    rng = np.random.default_rng(2)
    wiggly = [synthetic.demonstration(rng, duration=3.98, wiggle=0.06) for _ in range(2)]
    path = synthesise(wiggly, most_control_points=12)
    assert path.fit.largest > path.fit.bound
    assert f"within {path.fit.largest * 1e2:.2g} cm only, not 5 mm" in path.note
    assert "of its size), by 12 control points" in path.note
    assert len(path.curve.weights) == 12
    closer = synthesise(wiggly, most_control_points=100)
    assert closer.fit.largest <= closer.fit.bound
    assert closer.note == ""


def test_noise_left_falls_with_the_number_of_demonstrations() -> None:
    few, many = (residual_noise(synthetic.shown(synthetic.loop(), count)[0]) for count in (2, 8))
    assert many == pytest.approx(few / 2, rel=0.3)


def test_thirteen_control_points_are_enough_for_half_a_centimetre() -> None:
    for kind in KINDS.values():
        trajectories, _ = synthetic.shown(kind, 3)
        assert len(synthesise(trajectories, error_bound=0.005).curve.weights) <= 13


def small(noise: float) -> list[Trajectory]:
    """Five of a task of 5 cm."""
    rng = np.random.default_rng(4)
    large = [synthetic.demonstration(rng, duration=3.98, tremor=0.0, noise=0.0) for _ in range(5)]
    return [Trajectory(d.times, 0.07 * d.positions + rng.normal(0, noise, d.positions.shape)) for d in large]


def test_the_bound_is_one_hundredth_of_the_size_of_a_small_path() -> None:
    path = synthesise(small(2e-5))
    size = extent(path.curve(np.linspace(0, 1, 500)))
    assert path.fit.bound == pytest.approx(0.01 * size, rel=0.02)
    assert path.fit.largest <= path.fit.bound
    assert path.note == ""


def test_the_relative_bound_gives_way_to_noise_and_says_so() -> None:
    path = synthesise(small(0.005))
    assert path.fit.largest <= path.fit.bound <= LearningSettings().error_bound
    assert "because of the noise in its demonstrations" in path.note
    assert " 0 mm" not in path.note


@pytest.mark.parametrize("bound", [0.005, 0.05])
def test_mode_paper_stays_near_its_points_and_widens_its_bound_where_they_zigzag(bound: float) -> None:
    rng = np.random.default_rng(3)
    shown = [synthetic.demonstration(rng) for _ in range(2)]
    settings = LearningSettings(mode="paper", threshold=0.1, error_bound=bound, most_control_points=30)
    path = synthesis.fit_pooled_points(1, shown, settings, on_step=lambda: None)
    points = np.concatenate([trajectory.positions for trajectory in shown])
    curve = path.curve(np.linspace(0, 1, 5000))
    swing = np.maximum(points.min(axis=0) - curve.min(axis=0), curve.max(axis=0) - points.max(axis=0)).max()
    assert path.fit.largest <= path.fit.bound
    assert swing <= path.fit.bound
    assert len(path.curve.weights) <= 30
    assert ("zigzag" in path.note) == (path.fit.bound > bound)


def test_modes_that_follow_the_paper_keep_the_bound_as_it_is_set() -> None:
    assert PAPER.bound_for(0.05) == PAPER.error_bound


@pytest.mark.parametrize("shape", [synthetic.curl, synthetic.retreat, synthetic.closed, synthetic.loop])
def test_a_path_of_five_centimetres_is_nowhere_more_than_a_fiftieth_of_its_size_off(
    shape: Callable[[int], Array],
) -> None:
    clean = shape(300)
    clean *= 0.05 / extent(clean)
    rng = np.random.default_rng(1)
    shown = [Trajectory(np.linspace(0, 3, 150), clean[::2] + rng.normal(0, noise, (150, 3))) for noise in 5 * [0.0003]]
    path = synthesise(shown)
    assert frechet_distance(at_equal_arc_length(path.curve(np.linspace(0, 1, 2000)), 300), clean) <= 0.02 * 0.05
