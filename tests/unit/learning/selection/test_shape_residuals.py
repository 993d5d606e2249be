"""Excess bending: a detour is found, while pace and slow drift say nothing, in whatever frame, unit or direction."""

from __future__ import annotations

import numpy as np

from teachpath.learning.resampling import smoothed
from teachpath.learning.selection.features import courses
from teachpath.learning.selection.shape_residuals import score_bending
from teachpath.records import Array
from tests.unit.learning import synthetic

FAMILIES = 40


def five(seed: int) -> Array:
    trajectories = list(synthetic.experiment_2(seed, wiggle=0.0).values())
    return np.stack(courses(trajectories, [smoothed(trajectory) for trajectory in trajectories]))


def detoured(seed: int) -> Array:
    """The fifth with a bump of 6 cm, across or along the path, somewhere in its middle."""
    rng = np.random.default_rng(seed)
    shown, side, at = five(seed), rng.normal(size=3), rng.uniform(0.3, 0.7)
    bump = np.exp(-0.5 * np.square((np.linspace(0, 1, shown.shape[1]) - at) / 0.09))
    shown[4] += 0.06 * bump[:, None] * side / np.linalg.norm(side)
    return shown


def test_a_detour_is_found_and_hardly_ever_where_there_is_none() -> None:
    spoilt = np.stack([score_bending(detoured(seed))[0] for seed in range(FAMILIES)])
    clean = np.stack([score_bending(five(seed))[0] for seed in range(FAMILIES)])
    assert np.mean(spoilt[:, 4] < -8) >= 0.9
    assert np.mean(spoilt[:, :4] < -8) <= 0.02
    assert np.mean(clean < -8) <= 0.06


def test_pace_and_slow_drift_say_nothing() -> None:
    rng = np.random.default_rng(1)
    shown = five(4)
    t = np.linspace(0, 1, shown.shape[1])
    for i in range(5):
        at = t + 0.05 * rng.normal() * np.sin(np.pi * t) + 0.02 * rng.normal() * np.sin(2 * np.pi * t)
        walked = np.column_stack([np.interp(at, t, shown[0, :, k]) for k in range(3)])
        shown[i] = walked + np.polynomial.legendre.legvander(2 * t - 1, 2) @ rng.normal(0, 0.02, (3, 3))
    shown += rng.normal(0, 0.0002, shown.shape)
    assert np.all(score_bending(shown)[0] > -8)


def test_frame_unit_order_and_direction_do_not_matter() -> None:
    shown = detoured(5)
    z = score_bending(shown)[0]
    rotation = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    np.testing.assert_allclose(score_bending(shown @ rotation.T + 2.0)[0], z, atol=1e-6)
    np.testing.assert_allclose(score_bending(shown[::-1])[0][::-1], z, atol=1e-6)
    np.testing.assert_allclose(score_bending(shown[:, ::-1])[0], z, atol=1e-6)
    np.testing.assert_allclose(score_bending(1.7 * shown)[0], z, rtol=2e-3)


def test_fewer_than_four_are_not_compared() -> None:
    z, profiles = score_bending(detoured(6)[:3])
    assert not z.any()
    assert profiles.shape == (3, 100)


def test_alike_and_standing_courses_give_finite_numbers() -> None:
    for shown in (np.repeat(five(7)[:1], 5, axis=0), np.zeros((5, 100, 3))):
        z, profiles = score_bending(shown)
        assert np.all(z == 0)
        assert np.all(np.isfinite(profiles))
