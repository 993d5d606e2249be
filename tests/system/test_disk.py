"""A real disk that is full, and one that is read-only: a clear state, and earlier takes untouched."""

import json
import os
import shutil
import subprocess
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from tests.waiting import HANG

pytestmark = pytest.mark.system

NAME_SPACE = ["unshare", "--user", "--map-root-user", "--mount"]


def may_mount() -> list[str] | None:
    """Return what to put before a command that mounts, or None where nobody may."""
    for words in ([] if os.geteuid() else ["unshare", "--mount"], NAME_SPACE):
        if words and shutil.which(words[0]):
            tried = subprocess.run([*words, "mount", "-t", "tmpfs", "none", "/mnt"], capture_output=True, check=False)
            if tried.returncode == 0:
                return words
    return None


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    words = may_mount()
    if words is None:
        pytest.skip("nobody may mount a small disk here: this needs root, or name spaces of users")
    folder = tmp_path_factory.mktemp("disk")
    command = [*words, sys.executable, "-m", "tests.system.full_disk", str(folder)]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, capture_output=True, text=True, timeout=HANG, cwd=root, check=False)
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


def test_a_full_disk_is_said_while_it_is_full(told: dict[str, Any]) -> None:
    (fault,) = told["full"]["faults"]
    assert "No space left on device; free space" in fault
    assert told["full"]["demonstrations"] == told["whole"]["demonstrations"] == 1
    assert told["freed"]["faults"] == []
    assert told["freed"]["demonstrations"] == 2


def test_a_read_only_disk_is_said_while_it_is_so(told: dict[str, Any]) -> None:
    (fault,) = told["read-only"]["faults"]
    assert "Read-only file system; free space or mend the folder" in fault
    assert told["read-only"]["demonstrations"] == 2
    assert told["mended"]["faults"] == []
    assert told["mended"]["demonstrations"] == 3


def test_no_earlier_take_is_touched_and_no_sample_is_uncounted(told: dict[str, Any]) -> None:
    names = ["whole", "full", "freed", "read-only", "mended"]
    for before, after in pairwise(names):
        assert told[before]["files"].items() <= told[after]["files"].items()
    assert (told["end"]["received"], told["end"]["lost"]) == (5 * 110, 0)
    assert told["end"]["verdicts"] == ["clean"] * 3
    assert told["end"]["readable"] == [True] * 3
