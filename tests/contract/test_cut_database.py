"""Recording over a line to PostgreSQL that is cut: no take is lost or doubled, and no doctor is needed."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import make_url

from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from tests.postgres import Server
from tests.system.proxy import Proxy
from tests.unit.recorder.recorders import Bench
from tests.unit.recording.hands import demonstration
from tests.waiting import wait_until

SAMPLE_COUNT = 110  # samples of a demonstration


@pytest.fixture
def line(postgres: Server) -> Iterator[Proxy]:
    with Proxy(postgres.socket) as line:
        yield line


@pytest.fixture
def settings(postgres: Server, line: Proxy, tmp_path: Path) -> StoreSettings:
    url = make_url(postgres.new_url()).set(host="127.0.0.1", port=line.port, query={})
    return StoreSettings(str(tmp_path), str(url))


def show(bench: Bench, take: int) -> None:
    bench.send(demonstration(1 + (take - 1) * SAMPLE_COUNT))
    bench.received(take * SAMPLE_COUNT)


def test_takes_of_while_the_line_was_cut_have_their_rows_when_it_is_back(settings: StoreSettings, line: Proxy) -> None:
    store = Store(settings)
    bench = Bench(store)
    try:
        bench.begin()
        show(bench, 1)
        line.drop(cut=True)
        show(bench, 2)
        show(bench, 3)
        (said,) = bench.recorder.faults()
        assert "2 takes are whole, and their rows are stored by themselves" in said
        assert "does not answer" in said
        line.go_on()
        wait_until(lambda: not bench.recorder.faults(), "the rows are stored")
        show(bench, 4)
        assert [(row.number, row.verdict) for row in store.demonstrations("lift")] == [
            (number, "clean") for number in range(1, 5)
        ]
    finally:
        bench.recorder.stop()
        store.close()


def test_a_service_that_ends_while_the_line_is_cut_leaves_the_rows_to_the_next(
    settings: StoreSettings, line: Proxy
) -> None:
    store = Store(settings)
    bench = Bench(store)
    bench.begin()
    show(bench, 1)
    line.drop(cut=True)
    show(bench, 2)
    bench.recorder.stop()
    store.close()
    line.go_on()
    store = Store(settings)
    bench = Bench(store)
    try:
        rows = store.demonstrations("lift")
        assert [row.number for row in rows] == [1, 2]
        assert [len(store.recordings.samples(row.recording, row.digest)) for row in rows] == [r.samples for r in rows]
        assert store.recordings.kept_rows.places() == set()
    finally:
        bench.recorder.stop()
        store.close()
