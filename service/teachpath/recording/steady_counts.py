"""The counts of a steady stream, from columns: one whose clock rises in small steps needs no look at every sample."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from teachpath.recording.demonstration import place_of
from teachpath.recording.stream_statistics import MAX_SEQUENCE_JUMP
from teachpath.records import Sample, SampleColumns, StreamStatistics


def count_steady(
    samples: Sequence[Sample], borders: Sequence[int], largest_clock_step: float
) -> list[StreamStatistics] | None:
    """Count the samples of a steady stream up to each border and after the last, as `StreamCounter` does.

    What the numbers passed over counts as lost. A step of the clock that is not over the largest one is no jump,
    whatever the rate, so that no sample has to be compared with those before it.

    Args:
        samples: in the order of their numbers.
        borders: rising numbers, each the first of the next part.
        largest_clock_step: [s] see RecordingSettings.

    Returns:
        The counts of each part, with its longest gap; None when the stream is not steady.
    """
    columns = SampleColumns.of(samples)
    passed_over, gaps_ns = (np.zeros(len(columns), dtype=np.int64) for _ in range(2))
    steps = np.diff(columns.sequence)
    gaps_ns[1:] = np.diff(columns.device_ns)
    rising = np.all((steps >= 1) & (steps <= MAX_SEQUENCE_JUMP))
    if not (rising and np.all((gaps_ns[1:] > 0) & (gaps_ns[1:] <= round(largest_clock_step * 1e9)))):
        return None
    passed_over[1:] = steps - 1
    ends = [place_of(columns, border) for border in borders]
    return [
        StreamStatistics(
            received=end - begin,
            lost=int(passed_over[begin:end].sum()),
            gaps=int(np.count_nonzero(passed_over[begin:end])),
            untracked=int(np.count_nonzero(~columns.tracked[begin:end])),
            longest_gap_ns=int(gaps_ns[begin:end].max(initial=0)),
        )
        for begin, end in pairwise([0, *ends, len(columns)])
    ]
