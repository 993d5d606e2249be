"""Readings that a tracker repeats while the hand moves are told from those of a hand at rest."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teachpath.recording.repeated_readings import RepeatedReadings, find_repeated
from teachpath.records import Array

RATE = 50.0  # [Hz]
COUNT = 150


def moved(seed: int, noise: float = 2e-4, *, rest: int = 0, count: int = COUNT) -> Array:
    """Return a hand that moves along a bow (n, 3) [m], rests, and moves on; minimum jerk (Flash & Hogan 1985)."""
    u = np.linspace(0.0, 1.0, count // 2)
    x = 0.5 * u**3 * (10 - 15 * u + 6 * u**2)
    x = np.concatenate([x, np.full(rest, x[-1]), x[-1] + x])
    path = np.column_stack([x, 0.2 * np.sin(np.pi * x), np.zeros(len(x))])
    return path + np.random.default_rng(seed).normal(0.0, 1.0, path.shape) * noise


def found(positions: Array, begin: int = 0, end: int | None = None) -> RepeatedReadings:
    times = np.arange(len(positions)) / RATE
    return find_repeated(times, positions, None, begin, len(positions) if end is None else end)


@given(
    seed=st.integers(0, 10_000),
    noise=st.sampled_from([0.0, 1e-5, 1e-4, 1e-3]),
    lattice=st.sampled_from([0.0, 1e-5, 5e-4]),
    rest=st.integers(0, 60),
    count=st.integers(60, 300),
)
def test_a_resting_hand_is_no_frozen_tracker(seed: int, noise: float, lattice: float, rest: int, count: int) -> None:
    positions = moved(seed, noise, rest=rest, count=count)
    if lattice:
        positions = np.round(positions / lattice) * lattice
    assert found(positions).longest <= 0.1


@given(seed=st.integers(0, 10_000), at=st.integers(25, 40), length=st.integers(6, 25), dither=st.booleans())
def test_a_tracker_that_freezes_while_the_hand_moves_is_found(seed: int, at: int, length: int, dither: bool) -> None:
    positions = moved(seed)
    shakes = np.random.default_rng(seed).normal(0.0, 1e-6, (length, 3)) * dither
    positions[at + 1 : at + 1 + length] = positions[at] + shakes
    freeze = found(positions)
    assert set(range(at + 1, at + 1 + length)) <= set(freeze.indices)
    assert freeze.longest == pytest.approx((length + 1) / RATE)
    assert freeze.longest_at == at


def test_a_tracker_that_stays_frozen_to_the_end_is_found() -> None:
    positions = moved(1)
    positions[40:] = positions[40]
    freeze = found(positions, 0, 120)
    assert freeze.longest_at == 40
    assert freeze.indices == tuple(range(41, 120))


@pytest.mark.parametrize("of", [2, 3, 5, 10])
def test_a_tracker_slower_than_its_samples_shows_its_own_rate(of: int) -> None:
    for seed in range(20):
        positions = moved(seed)
        slow = positions[np.arange(COUNT) // of * of]
        assert found(slow).measured_rate == pytest.approx(RATE / of, rel=0.25)


def test_a_hand_that_turns_in_its_place_is_measured() -> None:
    positions = moved(1)
    positions[31:60] = positions[30]
    angles = np.linspace(0.0, 1.0, COUNT)
    turns = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles, 0 * angles])
    times = np.arange(COUNT) / RATE
    assert find_repeated(times, positions, turns, 0, COUNT).indices == ()
    assert find_repeated(times, positions, None, 0, COUNT).indices == tuple(range(31, 60))


@pytest.mark.parametrize("count", [0, 1, 2, 5, 10])
def test_a_few_readings_or_none_that_differ_say_nothing(count: int) -> None:
    assert found(np.zeros((count, 3))) == RepeatedReadings()
