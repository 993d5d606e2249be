from dataclasses import replace

import pytest

from teachpath.errors import UnusableSettings
from teachpath.recording.phase_statistics import PhaseStatistics
from teachpath.recording.quality import assess_quality
from teachpath.recording.settings import RecordingSettings
from teachpath.records import StreamStatistics

SETTINGS = RecordingSettings()
CLEAN_STATISTICS = StreamStatistics(received=100, declared_rate=50.0, seen_rate=50.0)


def transport(statistics: StreamStatistics) -> PhaseStatistics:
    """Return a take of which everything is learned."""
    return PhaseStatistics(statistics, StreamStatistics(), statistics, StreamStatistics())


@pytest.mark.parametrize(
    ("changes", "word", "reason"),
    [
        ({}, "clean", ""),
        ({"duplicated": 1}, "repaired", "1 sample came twice"),
        ({"reordered": 3}, "repaired", "3 samples came late"),
        ({"received": 98, "lost": 2}, "repaired", "2 samples lost"),
        ({"received": 90, "lost": 10}, "reject", "10 of 100 samples are faulty, 10.0%, limit 5.0%"),
        ({"refused": 5}, "repaired", "5 samples refused"),
        ({"refused": 6}, "reject", "6 of 106 samples are faulty, 5.7%, limit 5.0%"),
        ({"untracked": 4}, "repaired", "4 samples untracked"),
        ({"outliers": 2}, "repaired", "2 samples jumping"),
        ({"outliers": 3, "untracked": 3}, "reject", "6 of 100 samples"),
        ({"out_of_workspace": 50}, "reject", "50 of 100 samples"),
        ({"conflicts": 40, "duplicated": 40}, "reject", "40 of 100 samples"),
        ({"reversals": 6}, "reject", "6 of 100 samples"),
        ({"reversals": 5}, "repaired", "5 samples swinging back and forth faster than a hand"),
        ({"late": 3}, "clean", ""),
        (
            {"repeated": 2, "measured_rate": 49.0},
            "repaired",
            "measures 49 times a second; 2 readings repeat the one before",
        ),
        (
            {"repeated": 50, "measured_rate": 19.0},
            "reject",
            "19 times a second; 50 readings repeat the one before, limit 20 Hz",
        ),
        (
            {"repeated": 6, "longest_freeze_ns": 140_000_000, "freeze_at_ns": 1_200_000_000, "measured_rate": 47.0},
            "reject",
            "the tracker repeats one reading for 0.14 s while the hand moves, 1.20 s after the grasp, limit 0.1 s",
        ),
        ({"longest_gap_ns": 300_000_000}, "reject", "a gap of 0.30 s, limit 0.25 s"),
        ({"clock_jumps": 1}, "reject", "clock jumps once"),
        ({"level_shifts": 2}, "reject", "the position leaps 2 times by over 5 cm and stays"),
        ({"seen_rate": 44.0}, "repaired", "the rate is 44 Hz, declared 50 Hz"),
        ({"seen_rate": 46.0}, "clean", ""),
        ({"seen_rate": 30.0, "declared_rate": 0.0}, "clean", ""),
    ],
)
def test_the_verdict_follows_the_numbers_and_says_them(changes: dict[str, int], word: str, reason: str) -> None:
    report = assess_quality(transport(replace(CLEAN_STATISTICS, **changes)), SETTINGS)  # type: ignore[arg-type]
    assert report.verdict == word
    assert reason in (report.reasons[0] if report.reasons else "")
    assert bool(report.reasons) == (word != "clean")


def test_the_limits_are_those_of_the_settings() -> None:
    lost = StreamStatistics(received=90, lost=10)
    assert assess_quality(transport(lost), replace(SETTINGS, largest_loss=0.1)).verdict == "repaired"
    gap = transport(replace(CLEAN_STATISTICS, longest_gap_ns=300_000_000))
    assert assess_quality(gap, replace(SETTINGS, longest_gap=0.3)).verdict == "clean"


def test_a_workspace_without_room_is_refused() -> None:
    with pytest.raises(UnusableSettings, match=r"workspace_low is 2 in y; it must be under workspace_high, 1\.5"):
        RecordingSettings(workspace_low=(-1.0, 2.0, 0.0))
