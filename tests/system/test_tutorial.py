"""The tutorial, command by command as it stands there, by somebody who has just begun."""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.system.processes import Service
from tests.waiting import HANG

pytestmark = pytest.mark.system

TUTORIAL = Path(__file__).parents[2] / "docs" / "tutorial.md"
MODULES = {".venv/bin/teachpath": "teachpath", ".venv/bin/teachpath-client": "teachpath_client"}
SAID_WORDS = {  # what the reader is told to see
    "demonstrations cup": "clean",
    "learn cup": "Learned paths",
    "plan cup/2": "least clearance",
    "run cup/2": "ended",
    "executions last": "ended",
    "export report cup": "cup.html",
}


def commands() -> Iterator[list[str]]:
    """Words of the commands behind the first, which set everything up, and `serve`."""
    for block in re.findall(r"```sh\n(.*?)```", TUTORIAL.read_text(), re.DOTALL):
        for line in block.splitlines():
            words = shlex.split(line)
            if words[0] in MODULES and words[1] != "serve":
                yield words


def test_it_leads_from_nothing_to_a_moved_arm_and_its_report(tmp_path: Path) -> None:
    seen = {}
    with Service(tmp_path / "teachpath-data") as service:
        environment = {**os.environ, "TEACHPATH_URL": service.url, "NO_COLOR": "1"}
        for program, *words in commands():
            command = [sys.executable, "-m", MODULES[program], *words]
            if MODULES[program] == "teachpath_client":
                command += ["--endpoint", service.endpoint]
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=HANG, cwd=tmp_path, env=environment, check=False
            )
            assert done.returncode == 0, (words, done.stderr)
            seen[" ".join(words)] = done.stdout + done.stderr
    assert {words: sentence in seen.get(words, "") for words, sentence in SAID_WORDS.items()} == dict.fromkeys(
        SAID_WORDS, True
    ), seen
