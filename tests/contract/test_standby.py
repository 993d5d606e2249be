"""Standing by: one service takes another's place when that has ended or counts as dead, and never before."""

import queue
import threading
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
import sqlalchemy as sa

from teachpath.errors import Conflict
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.lock import StationLock
from teachpath.offline.standby import await_turn
from tests.contract.test_services import presume_dead
from tests.postgres import Server
from tests.waiting import HANG

Waiting = tuple["Future[bool]", "queue.Queue[str]", threading.Event]


@pytest.fixture
def url(postgres: Server) -> Iterator[str]:
    url = postgres.new_url()
    yield url
    postgres.drop(url)


@contextmanager
def standing_by(settings: StoreSettings) -> Iterator[Waiting]:
    stop, said = threading.Event(), queue.Queue[str]()
    with ThreadPoolExecutor(1) as thread:
        try:
            yield thread.submit(await_turn, settings, stop, said.put), said, stop
        finally:
            stop.set()


@contextmanager
def a_service(settings: StoreSettings) -> Iterator[Store]:
    with StationLock(Path(settings.data_dir)):
        store = Store(settings)
        try:
            store.services.begin()
            yield store
        finally:
            store.close()


@pytest.mark.parametrize("database", ["sqlite", "postgresql"])
def test_who_stands_by_on_a_data_folder_waits_for_the_end_of_its_service(
    database: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    settings = StoreSettings(str(tmp_path), request.getfixturevalue("url") if database == "postgresql" else "", "cell")
    with ExitStack() as stack:
        with a_service(settings):
            turn, said, _ = stack.enter_context(standing_by(settings))
            assert f"is using {tmp_path}" in said.get(timeout=HANG)
            assert not turn.done()
        assert turn.result(HANG) is True


def test_who_stands_by_elsewhere_waits_until_the_service_has_ended_or_counts_as_dead(url: str, tmp_path: Path) -> None:
    here, there = (StoreSettings(str(tmp_path / name), url, "cell") for name in ("here", "there"))
    with a_service(here) as store, standing_by(there) as (turn, said, stop):
        assert "a service works on this database as station 'cell'" in said.get(timeout=HANG)
        assert not turn.done()
        with pytest.raises(Conflict, match="teachpath serve --standby"), a_service(there):
            pass
        stop.set()
        assert turn.result(HANG) is False
        with standing_by(there) as (later, said, _):
            said.get(timeout=HANG)
            presume_dead(url, store.services.id)
            assert later.result(HANG) is True
        with a_service(there):
            store.services.note_alive()  # the first was only cut off: it finds out, and does not come back
            assert "station 'cell'" in store.services.taken
            assert f"{tmp_path / 'there'}" in store.services.taken
            assert living(url) == [str(tmp_path / "there")]
            heard_at = store.services.heard_at
            store.services.note_alive()
            assert store.services.heard_at == heard_at


def test_one_that_was_cut_off_for_long_goes_on_where_nobody_took_its_place(url: str, tmp_path: Path) -> None:
    with a_service(StoreSettings(str(tmp_path), url, "cell")) as store:
        presume_dead(url, store.services.id)
        with a_service(StoreSettings(str(tmp_path / "other"), url, "another")):  # removes the row of whoever is dead
            before = store.services.heard_at
            store.services.note_alive()
            assert store.services.taken == ""
            assert store.services.heard_at > before
            assert living(url) == [str(tmp_path), str(tmp_path / "other")]


def test_who_stands_by_leaves_the_tables_as_they_are(postgres: Server, tmp_path: Path) -> None:
    url = postgres.new_url(tables=False)
    with standing_by(StoreSettings(str(tmp_path), url, "cell")) as (turn, _, _):
        assert turn.result(HANG) is True
    engine = sa.create_engine(url)
    assert sa.inspect(engine).get_table_names() == []
    engine.dispose()
    postgres.drop(url)


def living(url: str) -> list[str]:
    """Return the data folders of the services that the database knows."""
    engine = sa.create_engine(url)
    with engine.connect() as connection:
        places = connection.execute(sa.text("SELECT place FROM services ORDER BY place")).scalars().all()
    engine.dispose()
    return [place.partition(":")[2] for place in places]
