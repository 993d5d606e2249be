"""A doctor that is killed at random moments and run again: nothing is there twice, and nothing is lost.

`make bench` kills two hundred.
"""

import json
import subprocess
import sys
from pathlib import Path

from tests.waiting import HANG

TRIALS = 12


def test_a_doctor_that_was_killed_is_run_again_as_if_nothing_had_been(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.unit.offline.doctor_kills", str(tmp_path), str(TRIALS), "1"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=HANG, check=True)
    found = json.loads(done.stdout)
    assert found["killed"] > TRIALS / 2
    assert found["wrong"] == {}
