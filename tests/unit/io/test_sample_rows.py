"""Samples kept as rows."""

import gc

import pytest

from teachpath.io.store.sample_rows import SampleRows
from tests.unit.recording.hands import sample

SAMPLES = [sample(n, (0.1 * n, 0.0, 0.5)) for n in range(1, 301)]


@pytest.fixture
def rows() -> SampleRows:
    rows = SampleRows()
    for each in SAMPLES:
        rows.append(each)
    return rows


def test_what_is_read_is_what_was_added(rows: SampleRows) -> None:
    assert list(rows) == rows[:] == SAMPLES
    assert (len(rows), rows[0], rows[-1], rows[10:12]) == (300, SAMPLES[0], SAMPLES[-1], SAMPLES[10:12])
    with pytest.raises(IndexError):
        rows[300]


def test_columns_are_the_values_of_all_samples(rows: SampleRows) -> None:
    columns = rows.columns()
    for name in columns._fields:
        assert getattr(columns, name) == tuple(getattr(each, name) for each in SAMPLES)


def test_the_garbage_collector_visits_no_row(rows: SampleRows) -> None:
    gc.collect()
    assert not any(gc.is_tracked(value) for row in rows._rows for value in (row, *row))
