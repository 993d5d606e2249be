"""What the doctor finds in a data folder that was damaged in one way, and what it makes of it."""

import os
import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teachpath.errors import UnusableRecording
from teachpath.io.store.integrity import find_contradiction
from teachpath.io.store.recording_facts import amended, read_facts
from teachpath.io.store.recordings import Recordings
from teachpath.io.store.salvage import RecordingHeader, salvage
from teachpath.offline.exporting import export_demonstrations
from teachpath.offline.findings import ExitCode, FaultKind, exit_code
from teachpath.offline.learning_job import StoredDemonstrations
from teachpath.offline.leftovers import note_unnamed
from teachpath.offline.recording_checks import inspect
from teachpath.records import Calibration
from tests.unit.offline.damage import (
    change_row,
    contradictions,
    examined,
    file_of,
    flip,
    make_row,
    opened,
    rows_of,
)
from tests.unit.recording.hands import demonstration


def test_a_row_and_its_file_say_the_same(data: Path) -> None:
    for row in rows_of(data):
        found = inspect(file_of(data, row))
        assert found.is_whole
        assert found.digest == row.digest
        assert row.digest is not None
        numbers = [sample.sequence for sample in found.samples]
        assert (row.digest.samples, row.digest.size) == (row.samples, file_of(data, row).stat().st_size)
        assert (row.digest.first, row.digest.last) == (numbers[0], numbers[-1])
    assert examined(data) == []


Damage = Callable[[Path], object]
TRUNCATE: Damage = lambda file: os.truncate(file, file.stat().st_size * 2 // 3)  # noqa: E731
LOST_FILES: dict[str, tuple[FaultKind, Damage]] = {
    "deleted": (FaultKind.MISSING, lambda file: file.unlink()),
    "truncated": (FaultKind.DAMAGED, TRUNCATE),
    "empty": (FaultKind.DAMAGED, lambda file: file.write_bytes(b"")),
    "flipped": (FaultKind.DAMAGED, lambda file: flip(file, file.stat().st_size // 2)),
    "zeroed": (FaultKind.DAMAGED, lambda file: file.write_bytes(bytes(file.stat().st_size))),
    "foreign": (FaultKind.DAMAGED, lambda file: file.write_text("t,x,y,z")),
}


@pytest.mark.parametrize(("kind", "damage"), LOST_FILES.values(), ids=LOST_FILES.keys())
def test_what_is_lost_is_told_with_the_way_out_and_harms_nothing_else(
    data: Path, kind: FaultKind, damage: Damage
) -> None:
    before = rows_of(data)
    damage(file_of(data, before[1]))
    for mend in (False, True):
        findings = examined(data, mend=mend)
        (finding,) = findings
        assert (finding.kind, finding.mended) == (kind, False)
        assert "lift 2 (demo-2)" in finding.sentence
        assert "teachpath restore; or give it up: teachpath amend lift 2 --discard" in finding.sentence
        assert exit_code(findings) is ExitCode.UNMENDED
        assert rows_of(data) == before
    change_row(data, "demo-2", replace(before[1], discarded_ns=1))
    assert exit_code(examined(data)) is ExitCode.WHOLE


@pytest.mark.parametrize("damage", [damage for kind, damage in LOST_FILES.values() if kind is FaultKind.DAMAGED])
@pytest.mark.parametrize("kind", ["mcap", "csv", "lerobot"])
def test_export_and_learning_refuse_what_does_not_match_its_hash(
    data: Path, tmp_path: Path, damage: Damage, kind: str
) -> None:
    rows = rows_of(data)
    damage(file_of(data, rows[1]))
    with opened(data) as store, pytest.raises(UnusableRecording, match=r"not what was recorded.*teachpath doctor"):
        export_demonstrations(store, rows[1:2], kind, tmp_path / "out", trajectory=lambda row: pytest.fail("not read"))
    assert not any((tmp_path / "out").iterdir())
    with pytest.raises(UnusableRecording, match=r"lift/demo-2\.mcap is not what was recorded.*teachpath doctor"):
        StoredDemonstrations(Recordings(data / "recordings"), tuple(rows), None).read()


def test_an_edited_recording_is_no_damaged_one_and_is_refused_all_the_same(data: Path) -> None:
    row = rows_of(data)[0]
    file = file_of(data, row)
    file.write_bytes(amended(file.read_bytes(), replace(row, mark="bad")))
    assert inspect(file).is_whole  # it says itself what is in it, and is right
    (finding,) = examined(data)
    assert (finding.kind, finding.mended) == (FaultKind.EDITED, False)
    assert "whole, but not what was recorded" in finding.sentence
    with opened(data) as store, pytest.raises(UnusableRecording):
        store.recordings.samples(row.recording, row.digest)


@pytest.mark.parametrize("name", ["elsewhere.mcap", "demo-2.copy.mcap", "../other/demo-2.mcap"])
def test_a_recording_that_lies_elsewhere_is_moved_back(data: Path, name: str) -> None:
    file = file_of(data, rows_of(data)[1])
    target = file.parent / name
    target.parent.mkdir(exist_ok=True)
    file.rename(target)
    (finding,) = examined(data)
    assert (finding.kind, finding.mended) == (FaultKind.MOVED, True)
    assert contradictions(data) == []
    assert examined(data) == []


def test_a_copy_takes_the_place_of_a_damaged_recording(data: Path) -> None:
    file = file_of(data, rows_of(data)[1])
    shutil.copy(file, file.with_name("spare.mcap"))
    TRUNCATE(file)
    (finding,) = examined(data)
    assert (finding.kind, finding.mended) == (FaultKind.DAMAGED, True)
    assert "a whole copy took its place" in finding.sentence
    assert contradictions(data) == []
    assert file.with_name("demo-2.mcap.damaged").exists()


def test_a_copy_of_a_recording_is_set_aside(data: Path) -> None:
    before, file = rows_of(data), file_of(data, rows_of(data)[1])
    shutil.copy(file, file.with_name("demo-9.mcap"))
    shutil.copy(file, file.with_name("demo-2.mcap.part"))
    assert [(f.kind, f.mended) for f in examined(data)] == [(FaultKind.DOUBLED, True)] * 2
    assert rows_of(data) == before
    assert examined(data) == []
    assert sorted(f.name for f in file.parent.glob("*.copy")) == ["demo-2.mcap.part.copy", "demo-9.mcap.copy"]


def test_copies_under_the_name_of_a_torn_recording_make_no_second_demonstration(template: Path, tmp_path: Path) -> None:
    data = tmp_path / "data"
    shutil.copytree(template, data)
    (torn,) = data.rglob("*.part")
    shutil.copy(torn, torn.with_name("other.mcap.part"))
    shutil.copy(file_of(data, make_row("demo-1")), torn.with_name("third.mcap.part"))
    examined(data)
    assert len(rows_of(data)) == 4
    assert contradictions(data) == []


def test_two_rows_of_one_recording_are_told(data: Path) -> None:
    rows = rows_of(data)
    file_of(data, rows[2]).unlink()
    change_row(data, rows[2].id, replace(rows[2], recording=rows[1].recording))
    (finding,) = examined(data)
    assert (finding.kind, finding.mended) == (FaultKind.DOUBLED, False)
    assert "lift 3 (demo-3): it names the recording of demo-2" in finding.sentence


def test_only_a_summary_that_is_damaged_is_written_anew(data: Path) -> None:
    rows = rows_of(data)
    whole = file_of(data, rows[0]).read_bytes()
    os.truncate(file_of(data, rows[0]), len(whole) - 40)
    flip(file_of(data, rows[1]), file_of(data, rows[1]).stat().st_size - 30)
    assert [(f.kind, f.mended) for f in examined(data)] == [(FaultKind.DAMAGED, True)] * 2
    assert file_of(data, rows[0]).read_bytes() == whole
    assert contradictions(data) == []


def test_a_recording_that_is_a_folder_is_unreadable_and_no_traceback(data: Path) -> None:
    file = file_of(data, rows_of(data)[0])
    file.unlink()
    file.mkdir()
    (finding,) = examined(data)
    assert (finding.kind, finding.mended) == (FaultKind.UNREADABLE, False)


def test_a_row_that_says_nothing_is_told_and_the_others_are_examined(data: Path) -> None:
    with closing(sqlite3.connect(data / "teachpath.sqlite")) as database:
        database.execute("UPDATE demonstrations SET document = '{}' WHERE id = 'demo-1'")
        database.commit()
    file_of(data, make_row("demo-3")).unlink()
    kinds = [finding.kind for finding in examined(data)]
    assert FaultKind.UNREADABLE in kinds
    assert FaultKind.MISSING in kinds


def test_rows_of_before_digests_get_them(data: Path) -> None:
    before = rows_of(data)
    for row in before:
        change_row(data, row.id, replace(row, digest=None))
    TRUNCATE(file_of(data, before[2]))
    assert [(f.kind, f.mended) for f in examined(data)] == [
        (FaultKind.UNHASHED, True),
        (FaultKind.UNHASHED, True),
        (FaultKind.DAMAGED, False),
    ]
    assert rows_of(data)[:2] == before[:2]


def test_temporary_files_are_removed_and_nothing_else(data: Path) -> None:
    for name in ("transfers/abc/upload", "repairs/recordings/lift/x.mcap", "recordings/lift/demo-1.mcap.temporary"):
        (data / name).parent.mkdir(parents=True, exist_ok=True)
        (data / name).write_text("half")
    assert [(f.kind, f.mended) for f in examined(data)] == [(FaultKind.LEFTOVER, True)] * 3
    assert examined(data) == []
    assert contradictions(data) == []


def test_a_dry_run_changes_nothing_and_says_what_would_be_mended(template: Path, tmp_path: Path) -> None:
    data = tmp_path / "data"
    shutil.copytree(template, data)
    file_of(data, make_row("demo-2")).rename(data / "recordings" / "lift" / "moved.mcap")
    before = {file: file.read_bytes() for file in data.rglob("*") if file.suffix not in ("", ".lock", ".sqlite")}
    dry = examined(data, mend=False)
    assert [(f.kind, f.mended) for f in dry] == [(FaultKind.MOVED, False), (FaultKind.TORN, False)]
    assert exit_code(dry) is ExitCode.MENDABLE
    assert {file: file.read_bytes() for file in before} == before
    assert len(rows_of(data)) == 3
    assert exit_code(examined(data)) is ExitCode.WHOLE
    assert contradictions(data) == []


def test_without_a_database_every_row_is_made_anew_from_the_files(template: Path, tmp_path: Path) -> None:
    data = tmp_path / "data"
    shutil.copytree(template, data)
    before = rows_of(data)
    for file in data.glob("teachpath.sqlite*"):
        file.unlink()
    findings = examined(data)  # with no settings of scenes at all
    assert [f.kind for f in findings] == [FaultKind.ORPHANED] * 3 + [FaultKind.TORN]
    after = rows_of(data)
    assert after[:3] == before
    assert len(after) == 4
    assert contradictions(data) == []


def test_a_file_of_before_scenes_were_said_names_what_is_missing(data: Path) -> None:
    take = Recordings(data / "recordings").begin("demo-old", RecordingHeader("old", "glove", Calibration("identity")))
    for sample in demonstration():
        take.write(sample)
    take.leave()
    (finding,) = examined(data)
    assert not finding.mended
    assert "teachpath doctor --scene NAME" in finding.sentence


def test_a_damaged_recording_without_a_row_gives_the_samples_that_can_be_read(data: Path) -> None:
    row = rows_of(data)[0]
    for file in data.glob("teachpath.sqlite*"):
        file.unlink()
    os.truncate(file_of(data, row), file_of(data, row).stat().st_size * 2 // 3)
    readable = len(salvage(file_of(data, row))[1])
    findings = examined(data)
    assert sorted((f.kind, f.mended) for f in findings) == [
        (FaultKind.DAMAGED, True),
        (FaultKind.ORPHANED, True),
        (FaultKind.ORPHANED, True),
    ]
    assert next(f.samples for f in findings if f.kind is FaultKind.DAMAGED) == readable
    assert contradictions(data) == []
    assert file_of(data, row).with_name("demo-1.mcap.salvaged").exists()


@pytest.fixture(scope="module")
def whole(template: Path) -> bytes:
    return file_of(template, make_row("demo-1")).read_bytes()


@settings(max_examples=150, deadline=None)
@given(bit=st.integers(0, 8 * 10**6))
def test_a_file_alone_tells_of_every_flipped_bit(
    whole: bytes, tmp_path_factory: pytest.TempPathFactory, bit: int
) -> None:
    content = bytearray(whole)
    content[bit // 8 % len(content)] ^= 1 << bit % 8
    file = tmp_path_factory.getbasetemp() / "flipped.mcap"
    file.write_bytes(content)
    assert not inspect(file).is_whole


def test_an_amended_copy_states_what_is_in_it(whole: bytes, data: Path, tmp_path: Path) -> None:
    row = replace(rows_of(data)[0], mark="good")
    file = tmp_path / "copy.mcap"
    file.write_bytes(amended(whole, row))
    assert find_contradiction(file.read_bytes(), [sample.sequence for sample in salvage(file)[1]]) == ""
    assert '"mark":"good"' in read_facts(file)["demonstration"]


def test_a_service_says_that_it_has_recordings_without_rows(template: Path, tmp_path: Path) -> None:
    data = tmp_path / "data"
    shutil.copytree(template, data)
    with opened(data) as store:
        note_unnamed(store)
        assert store.health.faults() == []
    for file in data.glob("teachpath.sqlite*"):
        file.unlink()
    with opened(data) as store:
        note_unnamed(store)
        assert store.health.faults() == ["3 recordings have no row; stop the service and run: teachpath doctor"]
