"""Across a gap of lost setpoints no jerk is larger than the largest of any motion that could have been lost there."""

from dataclasses import dataclass

import numpy as np
import pytest

from teachpath_client.driver.least_jerk import LeastJerk

SPAN = 0.012  # s


@dataclass(frozen=True, eq=False)
class End:
    """One end of a gap."""

    nominal_ns: int
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


def lost(begin: np.ndarray, jerks: np.ndarray, cuts: np.ndarray) -> tuple[End, End]:
    """Return the ends of motions of six joints whose jerks (n, 6) hold between cuts (n + 1,) of the gap."""
    p, v, a = begin
    for jerk, t in zip(jerks, np.diff(cuts) * SPAN, strict=True):
        p, v, a = p + v * t + a * t**2 / 2 + jerk * t**3 / 6, v + a * t + jerk * t**2 / 2, a + jerk * t
    return End(0, *begin), End(round(1e9 * SPAN), p, v, a)


def largest_jerks(motion: LeastJerk) -> np.ndarray:
    accelerations = np.array([motion(t)[2] for t in np.linspace(0.0, SPAN, 241)])
    return np.asarray(np.abs(np.diff(accelerations, axis=0)).max(axis=0) / (SPAN / 240))


@pytest.mark.parametrize("seed", range(40))
def test_the_largest_jerk_is_no_larger_than_that_of_what_was_lost_and_both_ends_are_met(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pieces = int(rng.integers(1, 6))
    cuts = np.concatenate([[0.0], np.sort(rng.uniform(0.0, 1.0, pieces - 1)), [1.0]])
    jerks = rng.uniform(-200.0, 200.0, (pieces, 6)) if seed % 2 else rng.choice([-150.0, 150.0], (pieces, 6))
    one, two = lost(rng.normal(size=(3, 6)) * np.array([[1.0], [1.0], [10.0]]), jerks, cuts)
    motion = LeastJerk(one, two)
    assert np.all(largest_jerks(motion) <= np.abs(jerks).max(axis=0) * (1 + 1e-5) + 1e-3)
    for t, end in ((0.0, one), (SPAN, two)):
        p, v, a = motion(t)
        np.testing.assert_allclose(p, end.position, rtol=0, atol=1e-10)
        np.testing.assert_allclose(v, end.velocity, rtol=0, atol=1e-7)
        np.testing.assert_allclose(a, end.acceleration, rtol=0, atol=1e-4)


def test_joints_that_rest_stay_where_they_are() -> None:
    still = np.zeros(6)
    one, two = End(0, np.ones(6), still, still), End(12_000_000, np.ones(6), still, still)
    for t in (0.0, 0.005, SPAN):
        np.testing.assert_array_equal(LeastJerk(one, two)(t), [np.ones(6), still, still])
