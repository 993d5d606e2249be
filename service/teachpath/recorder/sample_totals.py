"""What was recorded since the service began, counted over all recordings: samples, their losses by kind, takes."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from teachpath.records import StreamStatistics, Verdict

LOSSES: Final = ("lost", "late", "duplicated", "conflicts", "refused", "untracked")  # fields of the statistics


@dataclass(frozen=True, slots=True)
class RecordingTotals:
    """Counts since the service began.

    Attributes:
        samples: that were received.
        losses: samples by what became of them, for each of `LOSSES`.
        takes: demonstrations that were made, for each verdict.
    """

    samples: int
    losses: dict[str, int]
    takes: dict[str, int]


class SampleTotals:
    """Keeps the counts of recordings that have ended; safe to use from several threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._samples: Counter[str] = Counter()
        self._takes: Counter[str] = Counter()

    def end_recording(self, statistics: StreamStatistics) -> None:
        """Add a recording that has ended."""
        with self._lock:
            self._samples += _counts(statistics)

    def end_take(self, verdict: Verdict) -> None:
        """Add a demonstration that was made."""
        with self._lock:
            self._takes[verdict.value] += 1

    def with_running(self, running: Iterable[StreamStatistics]) -> RecordingTotals:
        """Return the counts of all recordings, those that are running too."""
        with self._lock:
            samples, takes = self._samples.copy(), self._takes.copy()
        for statistics in running:
            samples += _counts(statistics)
        losses = {kind: samples[kind] for kind in LOSSES}
        return RecordingTotals(
            samples["received"], losses, {verdict.value: takes[verdict.value] for verdict in Verdict}
        )


def _counts(statistics: StreamStatistics) -> Counter[str]:
    return Counter({kind: getattr(statistics, kind) for kind in ("received", *LOSSES)})
