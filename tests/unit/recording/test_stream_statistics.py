import pytest
from hypothesis import given
from hypothesis import strategies as st

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


AT = START_NS + 3 * PERIOD_NS


@pytest.mark.parametrize(
    ("device_ns", "receive_ns", "jumps"),
    [
        (AT, AT + 1_000_000, 0),
        (AT + 5 * 10**9, AT + 5 * 10**9, 0),  # both clocks waited: a gap, not a jump
        (AT + 3600 * 10**9, AT + 1_000_000, 1),
        (AT - 10**9, AT + 1_000_000, 1),
        (AT, AT + 3 * 10**9, 0),  # a slow transit
        (AT, AT - 10**9, 0),  # our own clock was set back
    ],
)
def test_a_clock_jump_is_what_neither_the_numbers_nor_our_clock_explain(
    device_ns: int, receive_ns: int, jumps: int
) -> None:
    statistics = stream({}, {}, {"device_ns": device_ns, "receive_ns": receive_ns}).statistics()
    assert statistics.clock_jumps == jumps
    assert any("clock jumps" in note for note in statistics.notes) == bool(jumps)
    assert statistics.longest_gap_ns == (PERIOD_NS if jumps or device_ns == AT else 5 * 10**9 + PERIOD_NS)


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
    assert (statistics.statistics().duplicated, statistics.statistics().conflicts) == (2, 1)
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
