"""What PostgreSQL alone can do to a station: races, services that start together, a server that goes and returns."""

import signal
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from sqlalchemy import create_engine, text

from teachpath.errors import Conflict, StorageUnavailable
from teachpath.io.store.engine import open_engine
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from tests.contract.desk import Desk, refused
from tests.contract.rows import demonstration
from tests.postgres import Server
from tests.waiting import HANG, wait_until


@pytest.fixture
def store(postgres: Server, tmp_path: Path) -> Iterator[Store]:
    store = Store(StoreSettings(str(tmp_path), postgres.new_url()))
    store.ensure_task("t", scene="paper", calibration="identity")
    yield store
    store.close()


def test_two_who_wait_for_each_other_are_answered_as_a_conflict(store: Store, postgres: Server) -> None:
    keys = [store.add_demonstration(demonstration(f"d{i}")).id for i in range(2)]
    engine, both_hold_one = open_engine(postgres.new_url()), threading.Barrier(2)
    with engine.begin() as connection:
        connection.execute(text("CREATE TABLE pairs (key text PRIMARY KEY)"))
        connection.execute(text("INSERT INTO pairs VALUES ('a'), ('b')"))

    def change(order: str) -> str:
        try:
            with engine.begin() as connection:
                for number, key in enumerate(order):
                    connection.execute(text("UPDATE pairs SET key = key WHERE key = :key"), {"key": key})
                    if number == 0:
                        both_hold_one.wait(HANG)
        except Conflict as error:
            return str(error)
        return ""

    with ThreadPoolExecutor(2) as threads:
        won, lost = sorted(threads.map(change, ("ab", "ba")))
    assert not won
    assert "somebody else changed the same meanwhile" in lost
    engine.dispose()
    assert [d.id for d in store.demonstrations("t")] == keys


def test_services_that_start_together_make_the_tables_once(postgres: Server, tmp_path: Path) -> None:
    url, together = postgres.new_url(tables=False), threading.Barrier(3)

    def start(number: int) -> list[str]:
        together.wait(HANG)
        store = Store(StoreSettings(str(tmp_path / str(number)), url))
        try:
            store.ensure_task(f"t{number}", scene="paper", calibration="identity")
            return [task.name for task in store.tasks()]
        finally:
            store.close()

    with ThreadPoolExecutor(3) as threads:
        assert all(f"t{number}" in seen for number, seen in enumerate(threads.map(start, range(3))))


@pytest.mark.parametrize(
    ("statement", "sentence"),
    [
        ("ALTER DATABASE {name} SET default_transaction_read_only = on", "may only be read .*name the primary server"),
        ("ALTER DATABASE {name} CONNECTION LIMIT 0", "too many connections"),
        ("REVOKE INSERT ON tasks FROM guest", "may not be used so by this user .*let its owner grant that"),
    ],
)
def test_what_a_server_refuses_is_a_sentence(postgres: Server, tmp_path: Path, statement: str, sentence: str) -> None:
    url = postgres.new_url()
    name = url.partition("?")[0].rpartition("/")[2]
    owner = create_engine(url, isolation_level="AUTOCOMMIT")
    with owner.connect() as connection:
        if not connection.scalar(text("SELECT count(*) FROM pg_roles WHERE rolname = 'guest'")):
            connection.execute(text("CREATE ROLE guest LOGIN"))
        connection.execute(text("GRANT ALL ON ALL TABLES IN SCHEMA public TO guest"))
        store = Store(StoreSettings(str(tmp_path), url.replace("teachpath@", "guest@")))
        connection.execute(text(statement.format(name=name)))
        connection.execute(text("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE usename = 'guest'"))
    try:
        with pytest.raises(StorageUnavailable, match=sentence):
            store.ensure_task("t", scene="paper", calibration="identity")
    finally:
        store.close()
        owner.dispose()


def test_a_server_that_dies_is_a_sentence_and_no_restart_is_needed(desk: Desk, postgres: Server) -> None:
    """Nothing but the server comes back: the service does it by itself."""
    desk.put("/tasks/before", {})
    postgres.stop(signal.SIGQUIT)
    try:
        for answer in (desk.get("/tasks"), desk.put("/tasks/meanwhile", {})):
            refused(answer, 503, "does not answer")
        wait_until(lambda: "does not answer" in desk.get("/health").text, "the health says it")
        with pytest.raises(StorageUnavailable):
            desk.station.store.task("before")
    finally:
        postgres.start()
    assert "before" in [task["name"] for task in desk.get("/tasks").json()]
    assert desk.put("/tasks/after", {}).is_success
