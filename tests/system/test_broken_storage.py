"""A station on a disk that is full, or whose database is locked: a sentence with the way out, while it lasts."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.system.test_disk import may_mount
from tests.waiting import HANG

pytestmark = pytest.mark.system


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    words = may_mount()
    if words is None:
        pytest.skip("nobody may mount a small disk here: this needs root, or name spaces of users")
    command = [*words, sys.executable, "-m", "tests.system.broken_storage", str(tmp_path_factory.mktemp("disk"))]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, capture_output=True, text=True, timeout=HANG, cwd=root, check=False)
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


@pytest.mark.parametrize(
    ("trouble", "status", "way_out"),
    [("full", 507, "free space, then try again"), ("locked", 503, "end that process, then try again")],
)
def test_it_is_said_with_the_way_out_and_only_while_it_lasts(
    told: dict[str, Any], trouble: str, status: int, way_out: str
) -> None:
    found = told[trouble]
    for answered, sentence in found["answers"]:
        assert (answered, sentence.endswith(way_out)) == (status, True), sentence
    assert any(note.endswith(way_out) for note in found["notes"])
    assert (found["after"], found["left"]) == ("succeeded", [])
