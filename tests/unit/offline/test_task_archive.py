"""An archive of a task: what goes in comes out, and what was changed on the way is found."""

import hashlib
import io
import subprocess
import zipfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teachpath.errors import OverLimit, TeachpathError, UnusableInput
from teachpath.io.import_settings import ImportSettings
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.exporting import export_demonstrations
from teachpath.offline.task_archive import SUMS, TASK, unpacked_archive
from tests.unit.offline.takes import record, trajectory, whole

LIMITS = ImportSettings()


@pytest.fixture
def archive(store: Store, tmp_path: Path) -> Path:
    rows = [record(store, whole()) for _ in range(2)]
    (file,) = export_demonstrations(store, rows, "archive", tmp_path / "out", trajectory=trajectory(store))
    return file


def contents(file: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(file) as opened:
        return {name: opened.read(name) for name in opened.namelist()}


def written(file: Path, entries: dict[str, bytes], compression: int = zipfile.ZIP_STORED) -> Path:
    with zipfile.ZipFile(file, "w", compression) as opened:
        for name, content in entries.items():
            opened.writestr(name, content)
    return file


def test_the_task_and_its_recordings_come_out_as_they_went_in(store: Store, archive: Path) -> None:
    assert archive.name == "lift.zip"
    with unpacked_archive(archive, LIMITS) as unpacked:
        assert unpacked.task == store.task("lift")
        rows = store.demonstrations("lift")
        assert [file.name for file in unpacked.files] == [f"lift-{row.number:03d}.mcap" for row in rows]
        recorded = [store.recordings.content(row.recording, row.digest) for row in rows]
        assert [file.read_bytes() for file in unpacked.files] == recorded
    assert not any(file.exists() for file in unpacked.files)


def test_its_sums_are_checked_without_teachpath(archive: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(archive) as opened:
        opened.extractall(tmp_path)
    subprocess.run(["sha256sum", "--check", "--strict", SUMS], cwd=tmp_path / "lift", check=True, capture_output=True)


@settings(max_examples=200, deadline=None)
@given(place=st.integers(0, 10**9), value=st.integers(0, 255), cut=st.booleans())
def test_no_damage_goes_through_unseen(
    tmp_path_factory: pytest.TempPathFactory, whole_archive: bytes, place: int, value: int, cut: bool
) -> None:
    content = bytearray(whole_archive)
    place %= len(content)
    content[place] = value
    damaged = tmp_path_factory.mktemp("damaged") / "lift.zip"
    damaged.write_bytes(content[:place] if cut else content)
    try:
        with unpacked_archive(damaged, LIMITS) as unpacked:
            found = [hashlib.sha256(file.read_bytes()).hexdigest() for file in unpacked.files]
    except TeachpathError:
        return
    assert found == [hashlib.sha256(each).hexdigest() for each in recordings_of(whole_archive)]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"lift/lift-002.mcap": None}, r"lift-002\.mcap is missing in it"),
        ({"lift/lift-002.mcap": b"other"}, r"lift-002\.mcap is not what its SHA256SUMS says"),
        ({"lift/lift-009.mcap": b"more"}, r"lift-009\.mcap is in it and not in its SHA256SUMS"),
        ({f"lift/{SUMS}": None}, r"is no archive of a task: .*unpack it, and import the files"),
        ({f"lift/{TASK}": None}, "is no archive of a task"),
        ({f"lift/{SUMS}": b"moon\n"}, "line 1 of its SHA256SUMS names no recording: 'moon'"),
        ({f"lift/{SUMS}": b"0" * 64 + b"  ../../evil.mcap\n"}, "names no recording"),
        ({f"lift/{SUMS}": b"0" * 64 + b"  evil.sh\n"}, "names no recording"),
    ],
)
def test_what_was_changed_is_named(archive: Path, change: dict[str, bytes | None], sentence: str) -> None:
    entries = contents(archive)
    for name, content in change.items():
        if content is None:
            del entries[name]
        else:
            entries[name] = content
    with pytest.raises(UnusableInput, match=sentence), unpacked_archive(written(archive, entries), LIMITS):
        pass


def test_what_expands_to_too_much_is_refused_before_it_does(archive: Path) -> None:
    entries = contents(archive)
    bomb = bytes(50_000_000)
    entries["lift/lift-001.mcap"] = bomb
    sums = entries[f"lift/{SUMS}"].decode().splitlines()
    digest = hashlib.sha256(bomb).hexdigest()
    told = [f"{digest}  lift-001.mcap" if line.endswith("lift-001.mcap") else line for line in sums]
    entries[f"lift/{SUMS}"] = "\n".join(told).encode()
    packed = written(archive, entries, zipfile.ZIP_DEFLATED)
    with pytest.raises(OverLimit, match=r"lift-001\.mcap expands to over \d+ bytes"), unpacked_archive(packed, LIMITS):
        pass
    few = ImportSettings(max_motions=1)
    with pytest.raises(OverLimit, match=r"holds 2 recordings, limit 1 \("), unpacked_archive(packed, few):
        pass


def test_a_file_that_is_no_zip_file_and_one_that_is_not_there_are_said(tmp_path: Path) -> None:
    (tmp_path / "text.zip").write_text("moon")
    for name, sentence in (("text.zip", "damaged, or no zip file"), ("gone.zip", "No such file")):
        with pytest.raises(UnusableInput, match=sentence), unpacked_archive(tmp_path / name, LIMITS):
            pass


@pytest.fixture(scope="module")
def whole_archive(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    folder = tmp_path_factory.mktemp("archive")
    store = Store(StoreSettings(data_dir=str(folder / "data")))
    rows = [record(store, whole()) for _ in range(2)]
    (file,) = export_demonstrations(store, rows, "archive", folder, trajectory=trajectory(store))
    store.close()
    return file.read_bytes()


def recordings_of(content: bytes) -> list[bytes]:
    with zipfile.ZipFile(io.BytesIO(content)) as opened:
        return [opened.read(name) for name in sorted(opened.namelist()) if name.endswith(".mcap")]
