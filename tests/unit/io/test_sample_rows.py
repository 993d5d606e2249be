"""Samples kept in columns, whether they were added one by one or by the run."""

import gc
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teachpath.io.store.sample_rows import SampleRows
from teachpath.records import SampleColumns
from tests.unit.recording.hands import sample

SAMPLES = [sample(n, (0.1 * n, 0.0, 0.5)) for n in range(1, 301)]
COLUMNS = SampleColumns.of(SAMPLES)


@given(st.lists(st.integers(0, 300), max_size=8), st.sets(st.integers(0, 299), max_size=8))
def test_what_is_read_is_what_was_added(borders: list[int], looked_at: set[int]) -> None:
    rows = SampleRows()
    for k, (begin, end) in enumerate(pairwise([0, *sorted(borders), 300])):
        if k % 2:
            rows.extend(COLUMNS[begin:end])
        else:
            for each in SAMPLES[begin:end]:
                rows.append(each)
        assert all(rows[i] == SAMPLES[i] for i in looked_at if i < end)
    assert list(rows) == list(rows[:]) == list(rows.arrays()) == SAMPLES
    assert (len(rows), rows[0], rows[-1], list(rows[10:12])) == (300, SAMPLES[0], SAMPLES[-1], SAMPLES[10:12])
    with pytest.raises(IndexError):
        rows[300]


def test_the_garbage_collector_visits_few_objects_however_many_samples_wait() -> None:
    def visited(samples: int) -> int:
        """Return how many more objects the collector visits while so many samples wait."""
        gc.collect()
        before = len(gc.get_objects())
        rows = SampleRows()
        for each in (SAMPLES * 10)[:samples]:
            rows.append(each)
        gc.collect()
        return len(gc.get_objects()) - before if len(rows) == samples else -1

    assert 0 < visited(3000) < 3000 / 10
