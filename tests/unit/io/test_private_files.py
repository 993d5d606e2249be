"""Files and folders for their owner alone, whatever the process's mask and however they were made before."""

import os
import stat
from collections.abc import Iterator
from pathlib import Path

import pytest

from teachpath.errors import UnusableSettings
from teachpath.io.private_files import make_private, refuse_shared, write_private


@pytest.fixture(autouse=True)
def _open_mask() -> Iterator[None]:
    before = os.umask(0)
    yield
    os.umask(before)


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_a_file_is_written_whole_for_its_owner_alone(tmp_path: Path) -> None:
    file = tmp_path / "new" / "key"
    for content in ("first", "second"):
        write_private(file, content)
        assert file.read_text() == content
    assert (mode(file), mode(file.parent)) == (0o600, 0o700)
    assert list(file.parent.iterdir()) == [file]


def test_what_cannot_be_written_leaves_nothing_behind(tmp_path: Path) -> None:
    taken = tmp_path / "taken"
    taken.mkdir()
    with pytest.raises(OSError, match="taken"):
        write_private(taken, "in place of a folder")
    assert list(tmp_path.iterdir()) == [taken]


def test_a_folder_that_was_open_is_closed_and_one_that_is_missing_is_made(tmp_path: Path) -> None:
    was_open = tmp_path / "open"
    was_open.mkdir(mode=0o755)
    for folder in (was_open, tmp_path / "above" / "missing"):
        make_private(folder)
        assert mode(folder) == 0o700


@pytest.mark.parametrize("shared", [0o640, 0o604, 0o620, 0o666])
def test_a_file_that_others_may_read_or_write_is_refused(tmp_path: Path, shared: int) -> None:
    file = tmp_path / "key"
    file.touch()
    file.chmod(0o600)
    refuse_shared("the key", file.stat(), "make another")
    file.chmod(shared)
    with pytest.raises(UnusableSettings, match=f"read or write the key .mode {shared:04o}.*: make another"):
        refuse_shared("the key", file.stat(), "make another")
