"""What faults of a stream become, live, imported and repaired: every sample counted, no fault over its limit clean."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teachpath.recording.settings import RecordingSettings
from teachpath.recording.stream_statistics import StreamCounter
from tests.experiments.stream_faults import counted, expected
from tests.faults.faults import FAULTS, Fault, delay, double, drop, refuse, swap, swap_first, untrack
from tests.faults.routes import ROUTES, run, run_all
from tests.faults.streams import Stream, any_hand, shown

COMPOSED_FAULTS = (drop, delay, swap, swap_first, double, refuse, untrack)
FAULT_CASES = [
    pytest.param(fault, strength, id=f"{fault.key} {strength:g}") for fault in FAULTS for strength in fault.strengths
]


def faulty(fault: Fault, strength: float, seed: int) -> Stream:
    random = np.random.default_rng([seed, 7])
    return fault.change(shown(random), random, strength)


@settings(max_examples=60)
@given(
    seed=st.integers(0, 100_000),
    chosen=st.lists(st.tuples(st.sampled_from(COMPOSED_FAULTS), st.integers(1, 30)), min_size=1, max_size=5),
)
def test_all_that_was_sent_is_accounted_for_whatever_befell_it(seed: int, chosen: list) -> None:  # type: ignore[type-arg]
    random = np.random.default_rng(seed)
    stream = shown(random)
    for change, strength in chosen:
        stream = change(stream, random, strength)
    counter = StreamCounter(declared_rate=50.0, largest_clock_step=RecordingSettings().largest_clock_step)
    for event in stream.events:
        if event.refused:
            counter.count_refused("refused", event.sample.sequence if event.readable else None)
        else:
            counter.observe(event.sample)
    counter.count_missing_until(stream.sent)
    found = counted(counter.statistics())
    assert found == expected(stream)
    assert (
        stream.sent == found["received"] - found["duplicated"] - found["conflicts"] + found["lost"] + found["refused"]
    )


@pytest.mark.parametrize(("fault", "strength"), FAULT_CASES)
def test_no_fault_over_its_limit_is_clean_and_all_routes_agree(fault: Fault, strength: float) -> None:
    stream = faulty(fault, strength, 1)
    live = run(stream, "live")
    if fault.exact:
        assert live.statistics is not None
        assert counted(live.statistics) == expected(stream)
    for outcome in (live, *(run(stream, route) for route in ROUTES[1:])):
        assert outcome.verdict == live.verdict
        if abs(strength) > fault.limit:
            assert outcome.verdict != "clean"
        if fault.rejected is not None and abs(strength) > fault.rejected:
            assert not any(row.is_usable for row in outcome.rows)


@pytest.mark.parametrize("route", ROUTES)
def test_a_stream_without_a_fault_is_clean(route: str) -> None:
    randoms = [np.random.default_rng(seed) for seed in range(10)]
    streams = [shown(random, any_hand(random)) for random in randoms]
    assert [str(row.verdict) for row in run_all(streams, route).rows] == ["clean"] * len(streams)


@given(seed=st.integers(0, 10_000), places=st.integers(1, 150))
@settings(max_examples=20)
def test_a_sample_that_comes_late_changes_nothing_that_is_learned(seed: int, places: int) -> None:
    random = np.random.default_rng(seed)
    stream = shown(random)
    late = delay(stream, random, places)
    lost = set(range(1, stream.sent + 1)) - {e.sample.sequence for e in late.events}
    assert not lost
    (whole,), (other,) = run(stream, "live").learned, run(late, "live").learned
    assert len(whole.times) - 1 <= len(other.times) <= len(whole.times)
    for end in (0, -1):  # where a border itself comes late, its neighbour is the border
        assert math.dist(whole.positions[end], other.positions[end]) < 0.002
