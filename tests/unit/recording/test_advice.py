"""The advice to the operator: every fault that rejects has its own, says what to do, and is no list of figures."""

import re
from dataclasses import fields, replace

import pytest

from teachpath.recording.advice import FAULT_ADVICE, RETAKE
from teachpath.recording.phase_statistics import PhaseStatistics
from teachpath.recording.quality import FAULTS, assess_quality
from teachpath.recording.settings import RecordingSettings
from teachpath.records import StreamStatistics, Verdict

SETTINGS = RecordingSettings()
SOUND_STATISTICS = StreamStatistics(received=200)
FATAL_STATISTICS = {
    **dict.fromkeys(FAULTS, 40),
    "longest_gap_ns": 10**9,
    "level_shifts": 1,
    "clock_jumps": 1,
    "longest_freeze_ns": 10**9,
    "measured_rate": 10.0,
    "flaps": 5,
}


def advice(statistics: StreamStatistics) -> tuple[Verdict, str]:
    empty = StreamStatistics()
    report = assess_quality(PhaseStatistics(statistics, empty, statistics, empty), SETTINGS)
    return report.verdict, report.advice


def test_each_fatal_fault_has_an_advice_of_its_own_and_says_what_to_do() -> None:
    assert set(FATAL_STATISTICS) <= {field.name for field in fields(StreamStatistics)}
    said = {name: advice(replace(SOUND_STATISTICS, **{name: value})) for name, value in FATAL_STATISTICS.items()}
    assert {verdict for verdict, _ in said.values()} == {Verdict.REJECT}
    assert len({sentence for _, sentence in said.values()}) == len(FATAL_STATISTICS)
    for name, (_, sentence) in said.items():
        assert RETAKE in sentence, name
        assert not re.search(r"%|limit|samples?\b", sentence), sentence


@pytest.mark.parametrize("name", FATAL_STATISTICS)
def test_with_a_second_fault_the_advice_is_still_about_one_of_the_two(name: str) -> None:
    alone = {other: advice(replace(SOUND_STATISTICS, **{other: value}))[1] for other, value in FATAL_STATISTICS.items()}
    for other, value in FATAL_STATISTICS.items():
        both = advice(replace(SOUND_STATISTICS, **{name: FATAL_STATISTICS[name], other: value}))[1]
        assert both in (alone[name], alone[other])


def test_what_is_clean_needs_none_and_what_is_usable_says_so() -> None:
    assert advice(SOUND_STATISTICS) == (Verdict.CLEAN, "")
    verdict, sentence = advice(replace(SOUND_STATISTICS, lost=1))
    assert verdict is Verdict.REPAIRED
    assert sentence.startswith("usable")


def test_every_fault_that_is_counted_has_an_advice() -> None:
    assert set(FAULT_ADVICE) == set(FAULTS)
