"""The counts of a steady stream by columns are those of its samples one by one."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from teachpath.recording.steady_counts import count_steady
from teachpath.recording.stream_statistics import StreamCounter
from teachpath.records import Sample, StreamStatistics
from tests.unit.recording.hands import sample

SAMPLE_COUNT = 120
LARGEST_STEP = 0.1  # [s] five periods
PLACES = st.sets(st.integers(0, SAMPLE_COUNT - 1))
NAMES = ("received", "lost", "gaps", "untracked", "longest_gap_ns", "clock_jumps")


def one_by_one(samples: list[Sample], borders: list[int]) -> list[StreamStatistics]:
    counter, parts = StreamCounter(largest_clock_step=LARGEST_STEP), []
    for each in samples:
        while len(parts) < len(borders) and each.sequence >= borders[len(parts)]:
            parts.append(counter.interval())
            counter.begin_interval(counts_loss_before=True)
        counter.observe(each)
    return [*parts, counter.interval()]


@given(
    lost=PLACES,
    untracked=PLACES,
    first=st.integers(0, 2**63),
    begin=st.integers(0, SAMPLE_COUNT),
    end=st.integers(0, SAMPLE_COUNT),
)
def test_columns_count_what_samples_count(
    lost: set[int], untracked: set[int], first: int, begin: int, end: int
) -> None:
    samples = [
        sample(n, (0.0, 0.0, 0.0))._replace(sequence=first + n, tracked=n not in untracked)
        for n in range(SAMPLE_COUNT)
        if n not in lost
    ]
    borders = [first + min(begin, end), first + max(begin, end)]
    columns = count_steady(samples, borders, LARGEST_STEP)
    longest = max((b.device_ns - a.device_ns for a, b in pairwise(samples)), default=0)
    assert (columns is None) == (longest > LARGEST_STEP * 1e9)
    if columns is not None and samples and samples[-1].sequence >= borders[1]:
        for column, counted in zip(columns, one_by_one(samples, borders), strict=True):
            assert {name: getattr(column, name) for name in NAMES} == {name: getattr(counted, name) for name in NAMES}


def test_a_clock_that_stands_still_goes_back_or_leaps_is_not_steady() -> None:
    for step in (0, -1, round(LARGEST_STEP * 1e9) + 1):
        samples = [sample(n, (0.0, 0.0, 0.0))._replace(device_ns=10**10 + step * (n > 5)) for n in range(10)]
        assert count_steady(samples, [3, 6], LARGEST_STEP) is None
    same = [sample(1, (0.0, 0.0, 0.0)), sample(1, (0.0, 0.0, 0.0))._replace(device_ns=10**10)]
    assert count_steady(same, [3, 6], LARGEST_STEP) is None
