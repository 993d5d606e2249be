"""The doctor brings rows, files and objects together, loses nothing, and says what it cannot mend."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.backup import back_up
from teachpath.offline.doctor import examine
from teachpath.offline.findings import FaultKind, Finding
from tests.object_storage import BUCKET, ObjectServer
from tests.unit.io.spools import upload
from tests.unit.offline.damage import SETTINGS, TASK, drop_row, make_station

URL = f"s3://{BUCKET}/cell-1"
FIRST_KEY = f"cell-1/{TASK}/demo-1.mcap"


def of(data: Path) -> StoreSettings:
    return StoreSettings(str(data), recordings=URL)


def examined(data: Path, **options: bool) -> list[Finding]:
    store = Store(of(data))
    try:
        return examine(store, SETTINGS, {}, data, **options)  # type: ignore[arg-type]
    finally:
        store.close()


def kinds(findings: list[Finding]) -> list[tuple[FaultKind, bool]]:
    return [(finding.kind, finding.mended) for finding in findings]


def is_whole(data: Path) -> bool:
    """Whether all three demonstrations can be read."""
    store = Store(of(data))
    rows, read = store.demonstrations(TASK), store.recordings.samples
    shutil.rmtree(data / "cache", ignore_errors=True)
    whole = [len(read(row.recording, row.digest)) == row.samples for row in rows]
    store.close()
    return whole == [True] * 3


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("template")
    make_station(folder, 3)
    return folder


@pytest.fixture
def data(template: Path, tmp_path: Path, objects: ObjectServer) -> Path:
    return shutil.copytree(template, tmp_path / "data")


def test_what_waits_and_what_is_uploaded_is_no_fault(data: Path) -> None:
    assert examined(data) == []
    upload(of(data))
    assert examined(data) == []
    assert is_whole(data)


def test_what_a_kill_left_behind_is_cleared(data: Path) -> None:
    upload(of(data), passes=1)
    assert kinds(examined(data, mend=False)) == [(FaultKind.LEFTOVER, False)] * 3
    assert kinds(examined(data)) == [(FaultKind.LEFTOVER, True)] * 3
    assert examined(data) == []
    assert is_whole(data)


def test_an_object_that_is_gone_is_uploaded_again_where_its_file_is_still_here(
    data: Path, objects: ObjectServer
) -> None:
    upload(of(data), passes=1)
    del objects.objects[FIRST_KEY]
    gone, *left = examined(data)
    assert (gone.kind, gone.mended, kinds(left)) == (FaultKind.MISSING, True, [(FaultKind.LEFTOVER, True)] * 2)
    assert FIRST_KEY in objects.objects
    assert is_whole(data)


@pytest.mark.parametrize(
    ("damage", "kind", "said"),
    [
        (lambda objects: objects.pop(FIRST_KEY), FaultKind.MISSING, f"its object {URL}/{TASK}/demo-1.mcap is gone"),
        (lambda objects: objects.update({FIRST_KEY: b"else"}), FaultKind.DAMAGED, "is not what was recorded"),
    ],
)
def test_an_object_that_is_lost_is_said(
    data: Path, objects: ObjectServer, damage: Callable[[dict[str, bytes]], object], kind: FaultKind, said: str
) -> None:
    upload(of(data))
    damage(objects.objects)
    (lost,) = examined(data)
    assert (lost.kind, lost.mended, lost.mendable) == (kind, False, False)
    assert said in lost.sentence
    assert "bring it back from another version or a copy of the bucket" in lost.sentence


def test_a_damaged_object_never_costs_the_file(data: Path, objects: ObjectServer) -> None:
    upload(of(data), passes=1)
    objects.objects[FIRST_KEY] = b"else"
    assert "move it away and run the doctor again" in examined(data)[0].sentence
    del objects.objects[FIRST_KEY]  # as it says
    assert kinds(examined(data)) == [(FaultKind.MISSING, True)]
    assert is_whole(data)


def test_rows_of_an_older_backup_find_what_was_uploaded_since(data: Path, tmp_path: Path) -> None:
    shutil.copytree(data, tmp_path / "before")
    upload(of(data))
    shutil.copy(tmp_path / "before" / "teachpath.sqlite", data)
    assert is_whole(data)  # before the doctor, too
    assert kinds(examined(data)) == [(FaultKind.MOVED, True)] * 3
    assert examined(data) == []


def test_rows_are_made_anew_from_objects(data: Path, objects: ObjectServer) -> None:
    objects.objects["cell-1/notes.txt"] = b"not ours"
    upload(of(data))
    drop_row(data, "demo-1")
    (data / "teachpath.sqlite").unlink()
    assert kinds(examined(data)) == [(FaultKind.ORPHANED, True)] * 6  # each is fetched, and gets its row
    upload(of(data))
    assert examined(data) == []
    assert is_whole(data)
    assert not list((data / "recordings").glob("*/*.mcap"))


def test_while_nobody_answers_nothing_counts_as_lost(data: Path, objects: ObjectServer) -> None:
    upload(of(data))
    objects.stop()
    (finding,) = examined(data)
    assert (finding.kind, finding.mended) == (FaultKind.UNREADABLE, False)
    assert finding.sentence.startswith(f"3 recordings: s3://{BUCKET} does not answer")


def test_a_backup_says_what_stays_in_object_storage(data: Path, tmp_path: Path, objects: ObjectServer) -> None:
    store = Store(of(data))
    before = store.demonstrations(TASK)
    assert back_up(of(data), tmp_path / "whole").distant == 0
    upload(of(data))
    made = back_up(of(data), tmp_path / "rows")
    assert (made.distant, made.faults) == (3, ())
    # Rows that name files which were uploaded while the backup was made: it fetches them.
    for row in before:
        store.change_demonstration(row.id, recording=row.recording)
    store.close()
    made = back_up(of(data), tmp_path / "fetched")
    assert (made.distant, made.faults) == (0, ())
    assert replace(made, size=0) == replace(back_up(of(data), tmp_path / "again"), size=0)
    assert (tmp_path / "fetched" / "recordings" / TASK / "demo-1.mcap").read_bytes() == objects.objects[FIRST_KEY]
