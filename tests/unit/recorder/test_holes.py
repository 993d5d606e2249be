"""A hole in the numbers is said wherever it ends: in a phase of a take, between two takes, or takes later."""

import pytest

from tests.unit.recorder.recorders import Bench
from tests.unit.recording.hands import demonstration

SAMPLE_COUNT = 110  # samples of a take
BEGIN = 201  # number of the first sample that is lost, in the second take


@pytest.mark.parametrize("whole", [0, 1])  # takes that are lost between the torn ones
def test_a_take_that_lacks_samples_says_so_wherever_the_hole_ends(bench: Bench, whole: int) -> None:
    for end in range(
        300 + whole * SAMPLE_COUNT, 300 + (whole + 1) * SAMPLE_COUNT, 4
    ):  # number of the last one that is lost
        last = -(-end // SAMPLE_COUNT) * SAMPLE_COUNT + SAMPLE_COUNT
        bench.begin(task=f"hole-{end}")
        stream = [sample for first in range(1, last, SAMPLE_COUNT) for sample in demonstration(first)]
        bench.send([sample for sample in stream if not BEGIN <= sample.sequence <= end])
        report = bench.end(last)
        assert [(hole.first, hole.last) for hole in report.missing] == [(BEGIN, end)]
        torn = [row for row in bench.store.demonstrations(f"hole-{end}") if row.statistics.lost]
        assert torn
        for row in torn:
            said = ("a gap of ", f"{row.statistics.lost} samples lost")
            assert row.verdict != "clean", end
            assert any(words in reason for reason in row.reasons for words in said), (end, row.reasons)
