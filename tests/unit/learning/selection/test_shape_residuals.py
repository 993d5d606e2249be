"""Excess bending: a detour is found, while pace and slow drift say nothing, in whatever frame, unit or direction."""

from __future__ import annotations

import numpy as np

from teachpath.learning.resampling import at_equal_times, smoothed
from teachpath.learning.selection.shape_residuals import bending_surprises, measure_bending
from teachpath.records import Array
from tests.unit.learning import synthetic

FAMILIES = 40
SIZE = 0.66  # m
LIMIT = 1.5  # nats above the median


def five(seed: int) -> Array:
    trajectories = list(synthetic.experiment_2(seed, wiggle=0.0).values())
    return np.stack([at_equal_times(trajectory, 100, smoothed(trajectory)) for trajectory in trajectories])


def detoured(seed: int) -> Array:
    """The fifth with a bump of 6 cm, across or along the path, somewhere in its middle."""
    rng = np.random.default_rng(seed)
    shown, side, at = five(seed), rng.normal(size=3), rng.uniform(0.3, 0.7)
    bump = np.exp(-0.5 * np.square((np.linspace(0, 1, shown.shape[1]) - at) / 0.09))
    shown[4] += 0.06 * bump[:, None] * side / np.linalg.norm(side)
    return shown


def surprises(shown: Array, size: float = SIZE) -> Array:
    """By how many nats each is above the median."""
    found = bending_surprises(measure_bending(shown, size).energies)
    return found - np.median(found)


def test_a_detour_is_found_and_hardly_ever_where_there_is_none() -> None:
    spoilt = np.stack([surprises(detoured(seed)) for seed in range(FAMILIES)])
    clean = np.stack([surprises(five(seed)) for seed in range(FAMILIES)])
    assert np.mean(spoilt[:, 4] > LIMIT) >= 0.9
    assert np.mean(spoilt[:, :4] > LIMIT) <= 0.02
    assert np.mean(clean > LIMIT) <= 0.02


def test_pace_and_slow_drift_say_nothing() -> None:
    rng = np.random.default_rng(1)
    shown = five(4)
    t = np.linspace(0, 1, shown.shape[1])
    for i in range(5):
        at = t + 0.05 * rng.normal() * np.sin(np.pi * t) + 0.02 * rng.normal() * np.sin(2 * np.pi * t)
        walked = np.column_stack([np.interp(at, t, shown[0, :, k]) for k in range(3)])
        shown[i] = walked + np.polynomial.legendre.legvander(2 * t - 1, 2) @ rng.normal(0, 0.02, (3, 3))
    shown += rng.normal(0, 0.0002, shown.shape)
    assert np.all(surprises(shown) < LIMIT)


def test_frame_unit_order_and_direction_do_not_matter() -> None:
    shown = detoured(5)
    here = surprises(shown)
    rotation = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    np.testing.assert_allclose(surprises(shown @ rotation.T + 2.0), here, atol=1e-6)
    np.testing.assert_allclose(surprises(shown[::-1])[::-1], here, atol=1e-6)
    np.testing.assert_allclose(surprises(shown[:, ::-1]), here, atol=1e-6)
    for factor in (0.07, 1.7, 30.0):
        np.testing.assert_allclose(surprises(factor * shown, factor * SIZE), here, atol=1e-5)


def test_alike_and_standing_courses_give_finite_numbers() -> None:
    for shown in (np.repeat(five(7)[:1], 5, axis=0), np.zeros((5, 100, 3))):
        np.testing.assert_allclose(surprises(shown), 0.0, atol=1e-6)
