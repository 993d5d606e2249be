"""A task leaves one data folder as an archive and comes into another one."""

from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from teachpath.__main__ import app
from teachpath.errors import UnusableRecording
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.records import Demonstration
from tests.unit.offline.takes import TAKES, record, said


def teachpath(*words: str) -> Result:
    return CliRunner().invoke(app, words, catch_exceptions=False)


def rows(data: Path) -> list[Demonstration]:
    store = Store(StoreSettings(data_dir=str(data)))
    try:
        return store.demonstrations("lift")
    finally:
        store.close()


def test_all_of_a_task_is_brought_to_another_station(tmp_path: Path) -> None:
    here, there = tmp_path / "here", tmp_path / "there"
    store = Store(StoreSettings(data_dir=str(here)))
    first, *_ = [record(store, take()) for take in TAKES.values()]
    store.change_demonstration(first.id, mark="bad")
    store.close()
    made = ["export", "demonstrations", "lift", "--all", "--format", "archive", "--into", str(tmp_path)]
    assert teachpath(*made, "--data", str(here)).stdout == f"{tmp_path / 'lift.zip'}\n"
    archive = str(tmp_path / "lift.zip")
    assert teachpath("import", "lift", archive, "--dry-run", "--data", str(there)).exit_code == 0
    assert teachpath("import", "lift", archive, "--data", str(there)).exit_code == 0
    assert [(list(said(row)), row.mark) for row in rows(there)] == [(list(said(row)), row.mark) for row in rows(here)]
    with pytest.raises(UnusableRecording, match=r"lift\.zip is an archive: import it alone"):
        teachpath("import", "lift", archive, archive, "--data", str(there))
    assert len(rows(there)) == len(TAKES)
