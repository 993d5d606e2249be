"""A backup is consistent while others write, is compared before it comes back, and overwrites nothing."""

import os
import stat
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.io.store.database_files import DATABASE
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.backup import back_up, restore
from teachpath.offline.lock import StationLock
from tests.unit.offline.damage import contradictions, file_of, flip, make_station, opened, rows_of


@pytest.fixture
def data(tmp_path: Path) -> Path:
    make_station(tmp_path / "data", 3)
    return tmp_path / "data"


def of(folder: Path) -> StoreSettings:
    return StoreSettings(data_dir=str(folder))


def contents(data: Path) -> dict[str, bytes]:
    return {file.relative_to(data).as_posix(): file.read_bytes() for file in (data / "recordings").rglob("*.mcap")}


def test_what_was_backed_up_comes_back(data: Path, tmp_path: Path) -> None:
    with StationLock(data):  # the service runs
        assert back_up(of(data), tmp_path / "backup").faults == ()
    assert restore(tmp_path / "backup", of(tmp_path / "again")) is None
    assert rows_of(tmp_path / "again") == rows_of(data)
    assert contents(tmp_path / "again") == contents(data)
    assert contradictions(tmp_path / "again") == []


def test_nobody_else_reads_the_data_or_a_backup(tmp_path: Path) -> None:
    umask = os.umask(0o022)
    try:
        make_station(tmp_path / "data", 1)
        back_up(of(tmp_path / "data"), tmp_path / "backup")
        (tmp_path / "open").mkdir()
        Store(of(tmp_path / "open")).close()
    finally:
        os.umask(umask)
    for folder in ("data", "backup"):
        assert stat.S_IMODE((tmp_path / folder).stat().st_mode) == 0o700
    assert {stat.S_IMODE(f.stat().st_mode) for f in (tmp_path / "open").glob(f"{DATABASE}*")} == {0o600}


def test_a_backup_that_is_made_while_rows_are_written_is_whole(data: Path, tmp_path: Path) -> None:
    stopped = threading.Event()

    def write(store: Store) -> None:
        number = 0
        while not stopped.is_set():
            store.ensure_task(f"task-{number}", scene="paper", calibration="identity")
            number += 1

    with opened(data) as store:
        writer = threading.Thread(target=write, args=(store,))
        writer.start()
        try:
            for number in range(3):
                back_up(of(data), tmp_path / f"backup-{number}")
        finally:
            stopped.set()
            writer.join()
    for number in range(3):
        restore(tmp_path / f"backup-{number}", of(tmp_path / f"again-{number}"))
        assert contradictions(tmp_path / f"again-{number}") == []


@pytest.mark.parametrize(
    "harm",
    [
        lambda backup: flip(backup / "recordings" / "lift" / "demo-2.mcap", 99),
        lambda backup: (backup / "recordings" / "lift" / "demo-2.mcap").unlink(),
        lambda backup: flip(backup / "teachpath.sqlite", 5000),
        lambda backup: (backup / "manifest.json").write_text("{}"),
    ],
    ids=["flipped", "missing", "database", "manifest"],
)
def test_a_backup_that_was_damaged_is_refused_whole(data: Path, tmp_path: Path, harm: Callable[[Path], object]) -> None:
    back_up(of(data), tmp_path / "backup")
    harm(tmp_path / "backup")
    with pytest.raises(UnusableInput):
        restore(tmp_path / "backup", of(tmp_path / "again"))
    assert not (tmp_path / "again" / "recordings").exists()


def test_existing_data_are_never_overwritten(data: Path, tmp_path: Path) -> None:
    back_up(of(data), tmp_path / "backup")
    before = contents(data)
    with pytest.raises(Conflict, match="is there already"):
        back_up(of(data), tmp_path / "backup")
    with pytest.raises(Conflict, match="--replace"):
        restore(tmp_path / "backup", of(data))
    file_of(data, rows_of(data)[0]).unlink()
    aside = restore(tmp_path / "backup", of(data), replace=True)
    assert aside is not None
    assert sorted(file.name for file in aside.rglob("*.mcap")) == ["demo-2.mcap", "demo-3.mcap"]
    assert contents(data) == before
    assert contradictions(data) == []


def test_a_running_service_keeps_its_data(data: Path, tmp_path: Path) -> None:
    back_up(of(data), tmp_path / "backup")
    with StationLock(data), pytest.raises(Conflict, match="stop it first"):
        restore(tmp_path / "backup", of(data), replace=True)


def test_a_recording_that_was_damaged_before_is_named(data: Path, tmp_path: Path) -> None:
    rows = rows_of(data)
    flip(file_of(data, rows[0]), 99)
    file_of(data, rows[1]).unlink()
    first, second = back_up(of(data), tmp_path / "backup").faults
    assert first == "recordings/lift/demo-1.mcap is not what was recorded; run: teachpath doctor"
    assert second == "recordings/lift/demo-2.mcap is missing"


def test_there_must_be_something_to_back_up(tmp_path: Path) -> None:
    with pytest.raises(NotFound, match="--data"):
        back_up(of(tmp_path / "nothing"), tmp_path / "backup")
    assert list(tmp_path.iterdir()) == []
