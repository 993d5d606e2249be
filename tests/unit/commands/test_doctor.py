"""What `teachpath doctor` prints, and its exit codes."""

import json
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from teachpath.__main__ import app
from teachpath.errors import StorageUnavailable
from teachpath.offline.findings import ExitCode
from tests.unit.offline.damage import contradictions, drop_row, file_of, make_station, rows_of


@pytest.fixture
def data(tmp_path: Path) -> Path:
    make_station(tmp_path / "data", 2)
    return tmp_path / "data"


def doctor(data: Path, *words: str) -> Result:
    return CliRunner().invoke(app, ["doctor", "--data", str(data), *words], catch_exceptions=False)


def test_exit_codes_say_what_is_left(data: Path) -> None:
    assert (doctor(data).exit_code, doctor(data).stdout) == (0, f"{data}: every recording is whole\n")
    drop_row(data, "demo-2")
    assert doctor(data, "--dry-run").exit_code == ExitCode.MENDABLE == 3
    assert len(rows_of(data)) == 1
    said = json.loads(doctor(data, "--json").stdout)
    assert (said["exit_code"], [f["kind"] for f in said["findings"]]) == (0, ["orphaned"])
    assert said["findings"][0]["demonstrations"] == ["demo-2"]
    assert contradictions(data) == []
    file_of(data, rows_of(data)[0]).unlink()
    left = doctor(data)
    assert left.exit_code == ExitCode.UNMENDED == 4
    assert "1 of 1 faults are left" in left.stdout


def test_a_database_that_is_none_is_set_aside_and_made_anew(data: Path) -> None:
    before = rows_of(data)
    (data / "teachpath.sqlite").write_bytes(b"no database" * 1000)
    with pytest.raises(StorageUnavailable, match=r"is no database .* teachpath doctor --rebuild"):
        doctor(data)
    assert doctor(data, "--rebuild", "--dry-run").exit_code == ExitCode.MENDABLE
    assert not (data / "teachpath.sqlite.aside-1").exists()
    assert doctor(data, "--rebuild").exit_code == 0
    assert (data / "teachpath.sqlite.aside-1").read_bytes().startswith(b"no database")
    assert rows_of(data) == before


def test_a_dry_run_makes_no_database(data: Path) -> None:
    for file in data.glob("teachpath.sqlite*"):
        file.unlink()
    assert doctor(data, "--dry-run").exit_code == ExitCode.MENDABLE
    assert not list(data.glob("teachpath.sqlite*"))
    shutil.rmtree(data / "recordings")
    assert doctor(data).exit_code == 0
