import pytest
from hypothesis import given
from hypothesis import strategies as st

from teachpath.recording.arrival import Arrival
from teachpath.recording.stream_statistics import StreamCounter
from tests.unit.recording.hands import PERIOD_NS, START_NS, sample


def counter_of(sequences: list[int], expected: int | None = None) -> StreamCounter:
    statistics = StreamCounter()
    for sequence in sequences:
        statistics.observe(sample(sequence, (0.0, 0.0, 0.0)))
    if expected is not None:
        statistics.count_missing_until(expected)
    return statistics


@given(
    sent=st.integers(2, 60),
    kept=st.sets(st.integers(2, 60)),
    twice=st.lists(st.integers(1, 60), max_size=10),
    order=st.randoms(use_true_random=False),
)
def test_every_sample_sent_is_received_or_lost(sent: int, kept: set[int], twice: list[int], order) -> None:  # type: ignore[no-untyped-def]
    arrived = [n for n in range(2, sent + 1) if n in kept]
    stream = arrived + [n for n in twice if n in arrived]
    order.shuffle(stream)
    statistics = counter_of([1, *stream], sent).statistics()
    assert statistics.lost == sent - 1 - len(arrived)
    assert statistics.duplicated == len(stream) - len(arrived)
    assert statistics.received == 1 + len(stream)


def test_order_decides_between_late_and_in_time() -> None:
    statistics = counter_of([1, 2, 5, 3, 4, 4, 6]).statistics()
    assert (statistics.reordered, statistics.duplicated, statistics.lost) == (2, 1, 0)


def test_a_restarted_device_is_noted_not_counted_as_a_million_lost() -> None:
    statistics = counter_of([1, 2, 5_000_000]).statistics()
    assert statistics.lost == 0
    assert any("restarted" in note for note in statistics.notes)


def test_nothing_came_is_said() -> None:
    statistics = counter_of([], 40).statistics()
    assert any("no sample came" in note for note in statistics.notes)


def test_the_longest_gap_is_that_of_the_devices_clock() -> None:
    assert counter_of([1, 2, 6, 7]).statistics().longest_gap_ns == 4 * 20_000_000


def stream(*changes: dict[str, object], rate: float = 0.0) -> StreamCounter:
    statistics = StreamCounter(declared_rate=rate)
    for n, change in enumerate(changes, 1):
        statistics.observe(sample(n, (0.0, 0.0, 0.0), **change))
    return statistics


def test_gaps_are_stretches_of_numbers_and_a_late_sample_fills_its_own() -> None:
    statistics = counter_of([1, 2, 6, 7, 9])
    assert (statistics.statistics().gaps, statistics.statistics().lost) == (2, 4)
    statistics.observe(sample(4, (0.0, 0.0, 0.0)))
    assert (statistics.statistics().gaps, statistics.statistics().lost, statistics.statistics().reordered) == (3, 3, 1)
    for late in (3, 5, 8):
        statistics.observe(sample(late, (0.0, 0.0, 0.0)))
    assert (statistics.statistics().gaps, statistics.statistics().lost) == (0, 0)


def test_a_hostile_stream_of_large_jumps_needs_no_more_room_than_its_samples() -> None:
    statistics = counter_of([i * 99_999 for i in range(500)])
    assert statistics.statistics().gaps == 499
    assert statistics.statistics().lost == 499 * 99_998


def test_the_seen_rate_is_that_of_the_device_and_loss_does_not_lower_it() -> None:
    assert counter_of([1, 2, 3, 8, 9]).statistics().seen_rate == pytest.approx(50.0)


STAMP_NS = START_NS + 3 * PERIOD_NS


@pytest.mark.parametrize(
    ("device_ns", "receive_ns", "jumps"),
    [
        (STAMP_NS, STAMP_NS + 1_000_000, 0),
        (STAMP_NS + 5 * 10**9, STAMP_NS + 5 * 10**9, 0),  # both clocks waited: a gap, not a jump
        (STAMP_NS + 3600 * 10**9, STAMP_NS + 1_000_000, 1),
        (STAMP_NS - 10**9, STAMP_NS + 1_000_000, 1),
        (STAMP_NS + 2 * 10**8, STAMP_NS + 1_000_000, 1),  # the clock is set ahead by 0.2 s
        (STAMP_NS + 5 * 10**7, STAMP_NS + 1_000_000, 0),  # by less than the limit
        (STAMP_NS - 3 * 10**7, STAMP_NS + 1_000_000, 1),  # it runs back
        (STAMP_NS, STAMP_NS + 3 * 10**9, 0),  # a slow transit
        (STAMP_NS, STAMP_NS - 10**9, 0),  # our own clock was set back
    ],
)
def test_a_clock_jump_is_what_neither_the_numbers_nor_our_clock_explain(
    device_ns: int, receive_ns: int, jumps: int
) -> None:
    statistics = stream({}, {}, {"device_ns": device_ns, "receive_ns": receive_ns}).statistics()
    assert statistics.clock_jumps == jumps
    assert any("clock jumps" in note for note in statistics.notes) == bool(jumps)
    assert statistics.longest_gap_ns == (PERIOD_NS if jumps else max(device_ns - STAMP_NS, 0) + PERIOD_NS)


def test_loss_at_many_times_real_time_is_no_clock_jump() -> None:
    statistics = StreamCounter()
    for n in [*range(1, 50), *range(150, 200)]:
        statistics.observe(sample(n, (0.0, 0.0, 0.0), receive_ns=START_NS + n * PERIOD_NS // 8))
    assert statistics.statistics().clock_jumps == 0
    assert statistics.statistics().longest_gap_ns == 101 * PERIOD_NS
    assert "the device's clock runs 8 x ours" in statistics.statistics().notes


def test_one_number_with_two_times_is_a_conflict() -> None:
    statistics = counter_of([1, 2, 3, 3])
    assert (statistics.statistics().duplicated, statistics.statistics().conflicts) == (1, 0)
    statistics.observe(sample(3, (0.1, 0.0, 0.0), device_ns=START_NS + 3 * PERIOD_NS + 7))
    assert (statistics.statistics().duplicated, statistics.statistics().conflicts) == (1, 1)
    statistics.observe(sample(3, (0.1, 0.0, 0.0)))  # the same time, another place
    assert (statistics.statistics().duplicated, statistics.statistics().conflicts) == (1, 2)
    assert any("two trackers" in note for note in statistics.statistics().notes)


def test_a_thousand_conflicts_are_one_sentence_and_hide_no_other() -> None:
    statistics = counter_of(list(range(1, 200)))
    statistics.note("the lamp is green")
    for n in range(1, 200):
        statistics.observe(sample(n, (0.1, 0.0, 0.0), device_ns=START_NS + n * PERIOD_NS + 7))
    assert statistics.statistics().conflicts == 199
    first, second = statistics.statistics().notes[:2]
    assert first == "the lamp is green"
    assert second.endswith("the number 1: do two trackers share this name? (and 198 more like it)")


def test_a_device_that_counts_anew_is_told_from_late_samples() -> None:
    statistics = counter_of(list(range(1, 40)))
    for n in range(1, 11):
        assert not statistics.has_restarted
        statistics.observe(sample(n, (0.0, 0.0, 0.0), device_ns=START_NS + (100 + n) * PERIOD_NS))
    assert statistics.has_restarted
    statistics.interrupt()
    assert statistics.observe(sample(11, (0.0, 0.0, 0.0), device_ns=START_NS + 111 * PERIOD_NS))
    assert not statistics.has_restarted
    assert any("counts anew" in note for note in statistics.statistics().notes)
    again = counter_of([*range(1, 40), *range(1, 30)])
    assert not again.has_restarted


def test_the_parts_of_a_stream_add_up_but_for_what_was_lost_between_them() -> None:
    whole = StreamCounter()
    parts = []
    for numbers in ([1, 2, 4, 3, 5], [9, 10, 12, 12], [13, 20]):
        whole.begin_interval()
        for n in numbers:
            whole.observe(sample(n, (0.0, 0.0, 0.0), tracked=n != 10))
        whole.note(f"up to {'abc'[len(parts)]}")
        parts.append(whole.interval())
    total = whole.statistics()
    for name in ("received", "duplicated", "reordered", "untracked"):
        assert sum(getattr(interval, name) for interval in parts) == getattr(total, name)
    assert [interval.lost for interval in parts] == [0, 1, 6]
    assert total.lost == 7 + 3
    assert [interval.longest_gap_ns // PERIOD_NS for interval in parts] == [2, 2, 7]
    assert [interval.notes for interval in parts] == [("up to a",), ("up to b",), ("up to c",)]
    assert total.notes == ("up to a", "up to b", "up to c")
    assert all(interval.seen_rate == pytest.approx(50.0) for interval in parts)


def test_a_pause_behind_a_slow_transit_is_no_clock_jump() -> None:
    delayed = {"receive_ns": STAMP_NS + 300_000_000}  # the machine stood still: this one came with the next
    after = {"device_ns": STAMP_NS + 300_000_000, "receive_ns": STAMP_NS + 301_000_000}
    assert stream({}, {}, delayed, after).statistics().clock_jumps == 0


def test_a_clock_that_stands_still_while_the_numbers_go_on_is_a_clock_jump() -> None:
    statistics = stream(*[{}] * 10, *[{"device_ns": START_NS + 10 * PERIOD_NS}] * 10, rate=50.0).statistics()
    assert statistics.clock_jumps == 1
    assert "the device's clock stands still at sample 16" in statistics.notes


@pytest.mark.parametrize("order", [[3, 1, 2, 4, 5], [5, 4, 3, 2, 1]])
def test_what_comes_before_the_first_number_is_late_not_twice(order: list[int]) -> None:
    statistics = counter_of(order, 5).statistics()
    assert (statistics.reordered, statistics.duplicated, statistics.lost, statistics.conflicts) == (
        sum(n < max(order[:i], default=0) for i, n in enumerate(order)),
        0,
        0,
        0,
    )


@pytest.mark.parametrize("ahead", [-500, -7, 0, 7, 500, 1_000_000])
@pytest.mark.parametrize("clock_ns", [0, 7, -3600 * 10**9, 3600 * 10**9])
def test_two_trackers_under_one_name_are_in_conflict_whatever_their_numbers_and_clocks(
    ahead: int, clock_ns: int
) -> None:
    statistics = StreamCounter(declared_rate=50.0)
    for n in range(1000, 1200):
        stamp = START_NS + n * PERIOD_NS
        statistics.observe(sample(n, (0.0, 0.0, 0.0)))
        other = stamp + PERIOD_NS // 2 + clock_ns
        statistics.observe(sample(n + ahead, (0.5, 0.0, 0.0), device_ns=other, receive_ns=stamp + PERIOD_NS // 2))
    found = statistics.statistics()
    assert found.conflicts >= 0.4 * found.received or found.clock_jumps >= 0.4 * found.received


def test_what_comes_late_to_an_interval_that_has_ended_is_counted_once_and_as_late() -> None:
    statistics = counter_of([1, 2, 4, 5])
    before = statistics.interval()
    statistics.begin_interval()
    arrivals = [statistics.observe(sample(n, (0.0, 0.0, 0.0))) for n in (3, 2, 6, 7, 4)]
    assert arrivals == [
        Arrival.LATE,
        Arrival.DUPLICATED,
        Arrival.IN_ORDER,
        Arrival.IN_ORDER,
        Arrival.DUPLICATED,
    ]
    after, whole = statistics.interval(), statistics.statistics()
    assert (before.lost, before.received) == (1, 4)
    assert (after.received, after.late, after.reordered, after.duplicated, after.lost) == (2, 0, 0, 0, 0)
    assert (whole.received, whole.late, whole.reordered, whole.duplicated, whole.lost) == (9, 1, 0, 2, 0)
    assert any("sample 3 came after its part of the recording was cut" in note for note in whole.notes)
