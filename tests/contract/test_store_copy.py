"""A station moves from one kind of database to another and back, and nothing is another than before."""

from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.errors import Conflict, StorageUnavailable, UnusableSettings
from teachpath.io.store.copying import copy_rows
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.records import ExecutorStatus, JournalEntry
from teachpath_proto.control import JournalVerb
from tests.contract.rows import a_job, demonstration, learned
from tests.postgres import Server
from tests.unit.io.test_documents import a_plan


def fill(url: str, folder: Path) -> None:
    store = Store(StoreSettings(data_dir=str(folder), database=url))
    try:
        store.ensure_task("t", scene="paper", calibration="identity")
        for number in range(3):
            store.add_demonstration(demonstration(f"d{number}"))
        store.add_job(a_job())
        store.finish_learning("learn-1", learned())
        store.add_job(a_job("plan-1", kind="plan"))
        store.put_execution("e", store.finish_planning("plan-1", a_plan()), ExecutorStatus(activity="on the path"))
        for number in range(3):
            store.journal.write(JournalEntry(number, "glove", JournalVerb.START, "e", "yes"))
    finally:
        store.close()


def test_rows_go_there_and_back(postgres: Server, tmp_path: Path) -> None:
    first, server, again = (
        f"sqlite:///{tmp_path}/first.sqlite",
        postgres.new_url(),
        f"sqlite:///{tmp_path}/again.sqlite",
    )
    fill(first, tmp_path)
    counts = copy_rows(first, server)
    assert counts["demonstrations"] == counts["journal"] == 3
    assert copy_rows(server, again) == counts
    stores = [Store(StoreSettings(data_dir=str(tmp_path), database=url)) for url in (first, server, again)]
    before, there, back = (store.lists.demonstrations("t").entries for store in stores)
    assert before == there == back
    stores[1].journal.write(
        JournalEntry(9, "glove", JournalVerb.STOP, "e", "yes")
    )  # numbers go on behind those that came
    assert [entry.at_ns for entry in stores[1].lists.journal().entries] == [9, 2, 1, 0]
    assert stores[1].add_demonstration(replace(before[0], id="d9")).number == 4
    for store in stores:
        store.close()


def test_rows_are_never_added_to_others(postgres: Server, tmp_path: Path) -> None:
    first, server = f"sqlite:///{tmp_path}/first.sqlite", postgres.new_url()
    fill(first, tmp_path)
    copy_rows(first, server)
    with pytest.raises(Conflict, match="name an empty one"):
        copy_rows(first, server)


@pytest.mark.parametrize(
    ("url", "kind", "sentence"),
    [
        ("postgresql+psycopg://nobody@/none?host=/nowhere", StorageUnavailable, "is its server running"),
        ("postgres", UnusableSettings, "is no URL of a database"),
        ("oracle+nothing://host/name", UnusableSettings, "is no URL of a database"),
    ],
)
def test_a_server_that_is_not_there_is_named(tmp_path: Path, url: str, kind: type[Exception], sentence: str) -> None:
    with pytest.raises(kind, match=sentence):
        Store(StoreSettings(data_dir=str(tmp_path), database=url))


def test_the_command_names_what_it_copied(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    fill(f"sqlite:///{tmp_path}/data/teachpath.sqlite", tmp_path / "data")
    said = CliRunner().invoke(
        app, ["store", "copy", str(tmp_path / "data"), str(tmp_path / "new")], catch_exceptions=False
    )
    assert "3 demonstrations" in said.stdout
    assert "rows, the same in both" in said.stdout
