"""Imports of several files: all or none, also where the process is killed."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from teachpath.errors import UnusableRecording
from teachpath.offline.findings import FaultKind
from teachpath.offline.pruning import prune
from teachpath.offline.staging import STAGING, abandoned_imports, begin_session, locked_staging
from tests.unit.offline.batches import FILES, TASK, run_batch, state, write_files
from tests.unit.offline.damage import examined
from tests.waiting import HANG

MOMENTS = 60


def test_all_files_are_stored_in_their_order(tmp_path: Path) -> None:
    outcomes = run_batch(tmp_path / "data", write_files(tmp_path / "files"))
    assert [row.number for outcome in outcomes for row in outcome.made] == [1, 2, 3]
    assert all(outcome.understood and not outcome.refusal for outcome in outcomes)
    assert state(tmp_path / "data") == (FILES, FILES, 0)


def test_one_bad_file_leaves_nothing_and_is_named(tmp_path: Path) -> None:
    outcomes = run_batch(tmp_path / "data", write_files(tmp_path / "files", bad=True))
    assert [bool(outcome.refusal) for outcome in outcomes] == [False, False, True]
    assert "2.csv: 1 samples are too few" in outcomes[-1].refusal
    assert [outcome.made for outcome in outcomes] == [()] * FILES
    assert state(tmp_path / "data") == (0, 0, 0)


def test_the_same_files_again_are_further_demonstrations(tmp_path: Path) -> None:
    files = write_files(tmp_path / "files")
    run_batch(tmp_path / "data", files)
    outcomes = run_batch(tmp_path / "data", files)
    assert [row.number for outcome in outcomes for row in outcome.made] == [4, 5, 6]


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(UnusableRecording, match=r"cannot read .*none\.csv"):
        run_batch(tmp_path / "data", [tmp_path / "none.csv"])


def test_an_import_that_is_killed_at_any_moment_is_none_or_all_and_goes_on(tmp_path: Path) -> None:
    run = subprocess.run(
        [sys.executable, "-m", "tests.unit.offline.batches", tmp_path, str(MOMENTS)],
        capture_output=True, text=True, check=True, timeout=HANG,
    )  # fmt: skip
    found = json.loads(run.stdout)
    assert len(found) > 5
    assert len(found) < MOMENTS  # the last one was not killed
    for after_kill, again, whole, orphans in found:
        assert after_kill in (0, FILES)
        assert (again, whole, orphans) == (FILES, FILES, 0)


def test_an_import_that_was_killed_is_told_and_is_removed_by_command_alone(tmp_path: Path) -> None:
    data, files = tmp_path / "data", write_files(tmp_path / "files")
    run_batch(data, files[:1])
    left = data / STAGING / "0123"
    left.mkdir()
    session = begin_session(left, TASK, [file.name for file in files])
    with locked_staging(left):
        assert abandoned_imports(data) == []  # it is under way
    (each,) = abandoned_imports(data)
    assert (each.folder, each.session) == (left, session)
    assert each.fault == "the import of 0.csv, 1.csv, 2.csv into wipe was cut off, nothing of it is stored"
    (found,) = examined(data)
    assert (found.kind, found.mended) == (FaultKind.ABANDONED, False)
    assert "teachpath prune" in found.sentence
    assert begin_session(left, TASK, []) == session  # it goes on as what it was
    assert prune(data, 1.0) == []
    assert prune(data, 0.0) == [left]
    assert examined(data) == []


def test_what_an_import_left_that_is_stored_is_removed_by_the_doctor(tmp_path: Path) -> None:
    data, files = tmp_path / "data", write_files(tmp_path / "files")
    run_batch(data, files)
    left = data / STAGING / "0123"
    left.mkdir()
    begin_session(left, TASK, [file.name for file in files])
    left.with_suffix(".json").write_text("{}")
    (found,) = examined(data)
    assert found.mended
    assert "all of it is stored" in found.sentence
    assert (abandoned_imports(data), len(recordings(data))) == ([], FILES)


def recordings(data: Path) -> list[Path]:
    return list((data / "recordings").glob("*/*.mcap"))
