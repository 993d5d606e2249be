"""Databases and folders that cannot be used: a sentence with the way out, whatever is the matter."""

import errno
import os
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from teachpath.errors import Conflict, StorageFull, StorageUnavailable
from teachpath.io.store.faults import storage_fault
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.storage_health import INTERVAL, LOCK_GRACE, StorageHealth
from teachpath.io.store.store import Store
from tests.contract.rows import demonstration

FILE = "teachpath.sqlite"


@pytest.fixture
def data(tmp_path: Path) -> Path:
    store = Store(StoreSettings(data_dir=str(tmp_path)))
    store.ensure_task("t", scene="paper", calibration="identity")
    store.close()
    return tmp_path


def made_by_a_newer_one(file: Path) -> None:
    with closing(sqlite3.connect(file)) as database:
        database.execute("UPDATE alembic_version SET version_num = '9999'")
        database.commit()


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (lambda file: file.write_bytes(b"hello" * 1000), "is no database .*teachpath restore.*doctor --rebuild"),
        (lambda file: os.truncate(file, 9000), "is damaged .*teachpath restore.*doctor --rebuild"),
        (made_by_a_newer_one, "newer teachpath than this one, .*update teachpath"),
        (lambda file: (file.unlink(), file.mkdir()), "cannot be opened .*let this user"),
    ],
    ids=["none", "truncated", "newer", "folder"],
)
def test_a_database_that_cannot_be_used_names_the_way_out(
    data: Path, damage: Callable[[Path], object], sentence: str
) -> None:
    damage(data / FILE)
    with pytest.raises(StorageUnavailable, match=sentence):
        Store(StoreSettings(data_dir=str(data)))


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can work as another user")
def test_a_folder_without_rights_is_said(data: Path) -> None:
    data.chmod(0o555)
    (data / FILE).chmod(0o444)
    program = (
        "import os, sys; from teachpath.io.store.store import Store\n"
        "from teachpath.io.store.settings import StoreSettings\n"
        "from teachpath.errors import StorageUnavailable\n"
        "os.setuid(65534)\n"
        "try:\n    Store(StoreSettings(data_dir=sys.argv[1])).ensure_task('u', scene='paper', calibration='identity')\n"
        "except StorageUnavailable as error:\n    print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", program, str(data)], capture_output=True, text=True, check=True)
    assert "let this user" in done.stdout


def test_a_file_that_may_grow_no_more_counts_as_a_full_disk(data: Path) -> None:
    program = (
        "import resource, signal, sys; from teachpath.io.store.store import Store\n"
        "from teachpath.io.store.settings import StoreSettings; from teachpath.errors import StorageUnavailable\n"
        "store = Store(StoreSettings(data_dir=sys.argv[1])); signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))\n"
        "try:\n    [store.ensure_task(f'u{i}', scene='paper', calibration='identity') for i in range(50)]\n"
        "except StorageUnavailable as error:\n    print(type(error).__name__, error)\n"
    )
    done = subprocess.run([sys.executable, "-c", program, str(data)], capture_output=True, text=True, check=True)
    assert done.stdout.startswith(("StorageFull", "StorageUnavailable")), done.stderr
    store = Store(StoreSettings(data_dir=str(data)))  # nothing half written is left
    assert "t" in {task.name for task in store.lists.tasks().entries}
    store.close()


@pytest.mark.parametrize(
    ("number", "kind"),
    [(errno.ENOSPC, StorageFull), (errno.EDQUOT, StorageFull), (errno.EROFS, StorageUnavailable), (errno.ENOENT, None)],
)
def test_an_error_of_the_disk_is_told_from_a_fault_of_ours(number: int, kind: type[Exception] | None) -> None:
    fault = storage_fault(OSError(number, os.strerror(number)), "recordings")
    assert (None if fault is None else type(fault)) is kind


def test_a_row_that_is_there_already_is_a_conflict(data: Path) -> None:
    store = Store(StoreSettings(data_dir=str(data)))
    try:
        store.add_demonstration(demonstration("d"))
        with pytest.raises(Conflict, match="read it anew"):
            store.add_demonstration(demonstration("d"))
    finally:
        store.close()


def test_health_says_that_a_database_is_locked_when_it_stays_so(data: Path) -> None:
    now = [0.0]
    store = Store(StoreSettings(data_dir=str(data)))
    health = StorageHealth(data / "recordings", store.health._engine, data / FILE, clock=lambda: now[0])
    with closing(sqlite3.connect(data / FILE)) as other:
        other.execute("BEGIN IMMEDIATE")
        assert health.faults() == []  # somebody writes, as is usual
        now[0] += LOCK_GRACE + INTERVAL
        (fault,) = health.faults()
        assert "is locked by another process" in fault
    now[0] += INTERVAL
    assert health.faults() == []
    health.note_lost("take demo-1 was not kept")
    assert health.faults() == ["take demo-1 was not kept"]
    store.close()
