"""What is learned of a take decides its verdict; what happened on the ways to the object and back is said."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teachpath.recording.phase_statistics import PhaseStatistics, phase_statistics
from teachpath.recording.phases import TransportSpan
from teachpath.recording.quality import QualityReport, assess_quality
from teachpath.recording.settings import RecordingSettings
from teachpath.recording.stream_statistics import StreamCounter
from teachpath.records import Sample
from tests.unit.recording.hands import PERIOD_NS, sample

SETTINGS = RecordingSettings()
REACH_SAMPLES, CARRY_SAMPLES, RETREAT_SAMPLES = 40, 60, 40  # samples that are sent
SAMPLE_COUNT = REACH_SAMPLES + CARRY_SAMPLES + RETREAT_SAMPLES
LONGEST_LOSS = int(SETTINGS.longest_gap * 1e9) // PERIOD_NS - 1  # samples that may be missing in a row


def sent(count: int = SAMPLE_COUNT) -> list[Sample]:
    return [sample(n, (0.0, 0.0, 0.0)) for n in range(count)]


def parts(samples: list[Sample], *, until: int = SAMPLE_COUNT, opened: bool = True) -> PhaseStatistics:
    """Return the parts of a take; `until`: samples that the client says it sent; `opened`: the hand was seen to."""
    stream = StreamCounter()
    for each in samples:
        stream.observe(each)
    stream.count_missing_until(until - 1)
    grasp = next(i for i, s in enumerate(samples) if s.sequence >= REACH_SAMPLES)
    release = next((i for i, s in enumerate(samples) if s.sequence >= REACH_SAMPLES + CARRY_SAMPLES), len(samples))
    return phase_statistics(samples, TransportSpan(grasp, release, not opened), stream.statistics(), SETTINGS)


def verdict(samples: list[Sample]) -> QualityReport:
    return assess_quality(parts(samples), SETTINGS)


@given(lost=st.sets(st.integers(1, SAMPLE_COUNT - 1)), twice=st.sets(st.integers(0, SAMPLE_COUNT - 1), max_size=5))
def test_every_sample_is_in_one_part(lost: set[int], twice: set[int]) -> None:
    kept = [s for s in sent() if s.sequence not in lost]
    try:
        made = parts([s for s in kept for _ in range(1 + (s.sequence in twice))])
    except StopIteration:  # nothing came after the reach
        return
    for name in ("received", "lost", "duplicated"):
        assert sum(getattr(part, name) for part in (made.reach, made.transport, made.return_)) == getattr(
            made.whole, name
        )
    gap = max(part.longest_gap_ns for part in (made.reach, made.transport, made.return_))
    assert gap == made.whole.longest_gap_ns


@given(begin=st.integers(1, SAMPLE_COUNT - 2), length=st.integers(1, 40))
def test_a_hole_rejects_a_take_only_where_it_is_learned(begin: int, length: int) -> None:
    hole = range(begin, min(begin + length, SAMPLE_COUNT - 1))
    judged = verdict([s for s in sent() if s.sequence not in hole])
    # The step over the hole is one to or from a sample that is carried.
    learned = begin + len(hole) >= REACH_SAMPLES and begin <= REACH_SAMPLES + CARRY_SAMPLES
    few = SETTINGS.largest_loss * CARRY_SAMPLES
    if not learned:
        way = "reaching" if begin < REACH_SAMPLES else "returning"
        assert judged.verdict == "repaired"
        (reason,) = judged.reasons
        assert reason.startswith(f"while {way}, outside what is learned: ")
        assert f"{len(hole)} sample" in reason
        assert (f"a gap of {(len(hole) + 1) * 0.02:.2f} s" in reason) == (len(hole) > LONGEST_LOSS)
    elif not few - 1 <= len(hole) <= few + 1:
        assert judged.verdict == ("repaired" if len(hole) < few else "reject")


def test_a_long_reach_does_not_make_light_of_what_is_lost_of_the_carried() -> None:
    count = 3000
    samples = [sample(n, (0.0, 0.0, 0.0)) for n in range(count + CARRY_SAMPLES + RETREAT_SAMPLES)]
    kept = [s for s in samples if s.sequence < count or s.sequence % 10 != 5]
    stream = StreamCounter()
    for each in kept:
        stream.observe(each)
    release = next(i for i, s in enumerate(kept) if s.sequence >= count + CARRY_SAMPLES)
    judged = assess_quality(
        phase_statistics(kept, TransportSpan(count, release), stream.statistics(), SETTINGS), SETTINGS
    )
    assert judged.verdict == "reject"
    assert "of 61 samples are faulty" in judged.reasons[0]


def test_a_late_sample_of_the_reach_hides_no_loss_of_the_carried() -> None:
    late, lost = 10, REACH_SAMPLES + 10
    samples = [s for s in sent() if s.sequence not in (late, lost)]
    samples.insert(REACH_SAMPLES + 20, sample(late, (0.0, 0.0, 0.0)))
    made = parts(samples)
    assert (made.whole.lost, made.transport.lost, made.transport.reordered, made.reach.reordered) == (1, 1, 0, 1)


def test_a_sample_that_comes_after_the_release_is_put_in_its_place() -> None:
    late = REACH_SAMPLES + 10
    samples = [s for s in sent() if s.sequence != late] + [sample(late, (0.0, 0.0, 0.0))]
    made = parts(samples)
    assert (made.whole.lost, made.transport.lost, made.transport.reordered, made.return_.reordered) == (0, 0, 1, 0)
    assert made.transport.longest_gap_ns == PERIOD_NS


@given(refused=st.sets(st.integers(1, SAMPLE_COUNT - 2), max_size=40), unread=st.integers(0, 3))
def test_what_was_refused_is_not_lost_as_well(refused: set[int], unread: int) -> None:
    stream = StreamCounter()
    for each in sent():
        if each.sequence in refused:
            stream.count_refused("no unit quaternion", each.sequence)
        else:
            stream.observe(each)
    for _ in range(unread):
        stream.count_refused("rubbish")
    samples = [s for s in sent() if s.sequence not in refused]
    grasp = next(i for i, s in enumerate(samples) if s.sequence >= REACH_SAMPLES)
    release = next(i for i, s in enumerate(samples) if s.sequence >= REACH_SAMPLES + CARRY_SAMPLES)
    made = phase_statistics(samples, TransportSpan(grasp, release), stream.statistics(), SETTINGS)
    assert made.whole.refused == len(refused) + unread
    for name in ("refused", "lost"):
        assert sum(getattr(p, name) for p in (made.reach, made.transport, made.return_)) == getattr(made.whole, name)
    assert made.whole.lost == 0


@pytest.mark.parametrize("opened", [True, False])
def test_what_only_the_handshake_told_was_sent_after_all_that_came(opened: bool) -> None:
    samples = sent() if opened else sent(REACH_SAMPLES + CARRY_SAMPLES)
    made = parts(samples, until=len(samples) + 7, opened=opened)
    assert (made.whole.lost, made.return_.lost, made.transport.lost) == (7, 7 * opened, 7 * (not opened))


def test_a_clock_that_jumps_while_the_hand_returns_is_said_and_rejects_nothing() -> None:
    for place, word in (
        (REACH_SAMPLES // 2, "repaired"),
        (REACH_SAMPLES + 5, "reject"),
        (SAMPLE_COUNT - 5, "repaired"),
    ):
        moved = [s._replace(device_ns=s.device_ns + 10**12 * (s.sequence >= place)) for s in sent()]
        judged = verdict(moved)
        assert judged.verdict == word, place
        assert "clock jumps once" in judged.reasons[0]


def test_untracked_samples_and_duplicates_are_said_of_their_part() -> None:
    samples = [s._replace(tracked=not 5 <= s.sequence < 25) for s in sent()]
    samples.insert(SAMPLE_COUNT - 3, samples[SAMPLE_COUNT - 4])
    assert verdict(samples).reasons == (
        "while reaching, outside what is learned: 20 samples untracked",
        "while returning, outside what is learned: 1 sample came twice",
    )
