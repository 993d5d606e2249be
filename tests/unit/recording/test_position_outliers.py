import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teachpath.recording.position_outliers import find_outliers
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Array
from tests.unit.recording.hands import PERIOD_NS, START_NS, sample

SETTINGS = RecordingSettings()
COUNT = 120


def moved(seconds: float = 2.4, length: float = 0.6) -> Array:
    """Return a minimum-jerk move along x (Flash & Hogan 1985)."""
    t = np.linspace(0.0, 1.0, COUNT)
    return np.column_stack([length * t**3 * (10 - 15 * t + 6 * t**2), np.zeros(COUNT), np.full(COUNT, 0.5)])


def faults(positions: Array, *, period_ns: int = PERIOD_NS):  # type: ignore[no-untyped-def]
    samples = [sample(i, tuple(p), device_ns=START_NS + i * period_ns) for i, p in enumerate(positions.tolist())]
    return find_outliers(samples, positions, SETTINGS)


@given(noise=st.floats(0.0, 0.004), seed=st.integers(0, 1000), length=st.floats(0.0, 2.0))
def test_a_hand_that_moves_smoothly_has_no_faults(noise: float, seed: int, length: float) -> None:
    tremor = np.random.default_rng(seed).normal(0.0, noise, (COUNT, 3))
    found = faults(moved(length=length) + np.clip(tremor, -3 * noise, 3 * noise))
    assert (found.outliers, found.level_shifts) == ((), 0)


def test_a_slow_tracker_of_a_fast_hand_has_no_faults() -> None:
    assert faults(moved(length=1.2)[::6], period_ns=100_000_000).outliers == ()


@pytest.mark.parametrize("at", [1, 5, 60, 118])
def test_a_position_that_jumps_away_and_back_is_named(at: int) -> None:
    positions = moved()
    positions[at] += [0.0, 0.2, 0.0]
    found = faults(positions)
    assert (found.outliers, found.level_shifts) == ((at,), 0)


def test_three_ghosts_in_a_row_are_named() -> None:
    positions = moved()
    positions[50:53] += [0.0, 0.3, 0.1]
    assert faults(positions).outliers == (50, 51, 52)


def test_a_position_that_jumps_and_stays_is_a_leap() -> None:
    positions = moved()
    positions[70:] += [0.0, 0.73, 0.0]
    found = faults(positions)
    assert (found.outliers, found.level_shifts) == ((), 1)


def test_a_hand_that_moved_on_during_a_loss_has_not_leapt() -> None:
    kept = np.r_[0:60, 66:COUNT]
    positions = moved(length=1.2)[kept]
    samples = [
        sample(int(i), tuple(p), device_ns=START_NS + int(i) * PERIOD_NS)
        for i, p in zip(kept, positions.tolist(), strict=True)
    ]
    assert find_outliers(samples, positions, SETTINGS).level_shifts == 0


def test_samples_out_of_the_workspace_are_counted() -> None:
    positions = moved()
    positions[:7, 2] = 2.6
    assert faults(positions).out_of_workspace == 7
    assert faults(positions[:3]).out_of_workspace == 3
