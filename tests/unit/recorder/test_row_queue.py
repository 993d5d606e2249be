"""Takes that end while the database is away: their rows follow by themselves, in order, once, also after a restart."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from teachpath.errors import Conflict, StorageUnavailable
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.leftovers import note_unnamed
from teachpath.records import Demonstration
from tests.unit.recorder.recorders import Bench
from tests.unit.recording.hands import demonstration
from tests.waiting import wait_until

SAMPLE_COUNT = 110  # samples of a demonstration


class CutStore(Store):
    """A store whose line to the database is cut at will: before a row comes there, or before that is said."""

    is_cut = False
    answers_are_cut = False

    def add_demonstration(self, demonstration: Demonstration) -> Demonstration:
        if self.is_cut:
            raise StorageUnavailable("the database is away")
        stored = super().add_demonstration(demonstration)
        if self.answers_are_cut:
            raise StorageUnavailable("the answer is away")
        return stored


@pytest.fixture
def settings(tmp_path: Path) -> StoreSettings:
    return StoreSettings(data_dir=str(tmp_path / "data"))


@pytest.fixture
def store(settings: StoreSettings) -> Iterator[CutStore]:
    store = CutStore(settings)
    yield store
    store.close()


@pytest.fixture
def bench(store: CutStore) -> Iterator[Bench]:
    bench = Bench(store)
    bench.begin()
    yield bench
    bench.recorder.stop()


def show(bench: Bench, take: int) -> None:
    bench.send(demonstration(1 + (take - 1) * SAMPLE_COUNT))
    bench.received(take * SAMPLE_COUNT)


def stored(store: Store) -> list[tuple[int, str]]:
    return [(row.number, row.verdict) for row in store.demonstrations("lift")]


def waits_for_none(bench: Bench) -> None:
    wait_until(lambda: not bench.recorder.faults(), "no row waits")


def test_rows_that_the_database_does_not_take_follow_in_their_order(bench: Bench, store: CutStore) -> None:
    show(bench, 1)
    store.is_cut = True
    show(bench, 2)
    show(bench, 3)
    assert stored(store) == [(1, "clean")]
    (said,) = bench.recorder.faults()
    assert said.startswith("2 takes are whole, and their rows are stored by themselves")
    assert said.endswith("the database is away")
    report = bench.until(lambda report: True)
    assert sum("its row is stored as soon as that is possible" in note for note in report.notes) == 1
    assert store.health.faults() == []
    store.is_cut = False
    waits_for_none(bench)
    show(bench, 4)
    assert stored(store) == [(number, "clean") for number in range(1, 5)]
    ids = [row.id for row in store.demonstrations("lift")]
    assert list(bench.until(lambda report: len(report.demonstrations) == 4).demonstrations) == ids
    assert [row.id for row, _ in bench.recorded] == ids
    assert store.recordings.kept_rows.places() == set()


def test_a_row_that_was_stored_before_the_line_was_cut_is_not_stored_again(bench: Bench, store: CutStore) -> None:
    store.answers_are_cut = True
    show(bench, 1)
    waits_for_none(bench)
    store.answers_are_cut = False
    show(bench, 2)
    assert stored(store) == [(1, "clean"), (2, "clean")]
    assert [row.number for row, _ in bench.recorded] == [1, 2]


def test_the_next_service_stores_what_still_waits_once(settings: StoreSettings, store: CutStore) -> None:
    store.is_cut = True
    bench = Bench(store)
    bench.begin()
    show(bench, 1)
    show(bench, 2)
    bench.recorder.stop()
    kept = store.recordings.kept_rows.read()
    note_unnamed(store)
    assert store.health.faults() == []  # no doctor is needed
    other = Store(settings)
    try:
        for _ in range(2):  # of the first stop, and of one that came before it could forget the files
            Bench(other).recorder.stop()
            assert [row.id for row in other.demonstrations("lift")] == [row.id for row in kept]
            assert other.recordings.kept_rows.places() == set()
            for row in kept:
                other.recordings.kept_rows.keep(row)
    finally:
        other.close()


def test_what_is_kept_of_no_recording_or_cannot_be_read_is_left_out(store: CutStore, bench: Bench) -> None:
    store.is_cut = True
    show(bench, 1)
    show(bench, 2)
    first, second = store.recordings.kept_rows.read()
    store.recordings.path(first.recording).unlink()
    (store.recordings.folder("lift") / f"{second.id}.mcap.row").write_text("{")
    assert store.recordings.kept_rows.read() == []


def test_the_newest_take_is_discarded_also_while_its_row_waits(store: CutStore, bench: Bench) -> None:
    store.is_cut = True
    show(bench, 1)
    show(bench, 2)
    rows = bench.recorder.rows
    assert rows.discard_newest("glove")
    assert [bool(row.discarded_ns) for row in store.recordings.kept_rows.read()] == [False, True]
    assert not rows.discard_newest("other")
    store.is_cut = False
    waits_for_none(bench)
    assert [bool(row.discarded_ns) for row in store.demonstrations("lift")] == [False, True]
    assert not rows.discard_newest("glove")


def test_a_task_is_kept_idle_only_when_its_rows_are_stored(store: CutStore, bench: Bench) -> None:
    store.is_cut = True
    show(bench, 1)
    bench.end(SAMPLE_COUNT)
    with pytest.raises(Conflict, match="takes of task lift wait for their rows: the database is away"):
        bench.recorder.kept_idle("lift").__enter__()
    store.is_cut = False
    with bench.recorder.kept_idle("lift"):
        assert stored(store) == [(1, "clean")]
