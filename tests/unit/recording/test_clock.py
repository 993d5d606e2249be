import numpy as np
import pytest

from teachpath.recording.clock import MIN_SAMPLES, DeviceClock
from teachpath.records import Clock
from tests.unit.recording.hands import PERIOD_NS, START_NS, sample

MS = 1_000_000


def estimated(offset_ns: int, *, rate: float = 1.0, jitter: float = 3.0, count: int = 400, seed: int = 0) -> Clock:
    """Let a clock that is `offset_ns` behind ours send over a link with exponential transits of mean `jitter` [ms]."""
    random = np.random.default_rng(seed)
    clock = DeviceClock()
    for n in range(count):
        device_ns = START_NS + n * PERIOD_NS
        ours_ns = START_NS + offset_ns + round(n * PERIOD_NS / rate)
        transit_ns = round(MS * random.exponential(jitter))
        clock.observe(sample(n, (0.0, 0.0, 0.0), device_ns=device_ns, receive_ns=ours_ns + transit_ns))
    found = clock.estimate()
    assert found is not None
    return found


@pytest.mark.parametrize("offset_ns", [0, 7 * MS, 3600 * 10**9, -86400 * 10**9])
@pytest.mark.parametrize("jitter", [0.0, 0.5, 5.0])
def test_the_offset_is_found_within_its_uncertainty(offset_ns: int, jitter: float) -> None:
    for seed in range(5):
        clock = estimated(offset_ns, jitter=jitter, seed=seed)
        assert 0 <= clock.offset_ns - offset_ns <= clock.uncertainty_ns + 1
        assert clock.uncertainty_ns <= jitter * MS
        assert clock.rate == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("rate", [0.5, 1.5, 4.0, 8.0])
def test_a_clock_that_runs_at_another_rate_is_measured(rate: float) -> None:
    clock = estimated(5 * MS, rate=rate, jitter=0.5)
    assert clock.rate == pytest.approx(rate, rel=0.01)
    newest = 399 * PERIOD_NS
    assert clock.offset_ns - 5 * MS == pytest.approx(round(newest / rate) - newest, abs=3 * MS)


def test_few_samples_say_nothing_and_a_restart_forgets() -> None:
    clock = DeviceClock()
    for n in range(MIN_SAMPLES):
        assert clock.estimate() is None
        clock.observe(sample(n, (0.0, 0.0, 0.0)))
    assert clock.estimate() is not None
    clock.restart()
    assert clock.estimate() is None


def test_samples_that_came_all_at_once_say_nothing() -> None:
    clock = DeviceClock()
    for n in range(50):
        clock.observe(sample(n, (0.0, 0.0, 0.0), receive_ns=START_NS))
    assert clock.estimate() is None
