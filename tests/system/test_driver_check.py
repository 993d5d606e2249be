"""A driver is checked over real sockets: the example keeps every rule.

That the simulated arm and the player keep them each time is shown by the unit tests, in a time of their own.
"""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.ports import free_ports
from tests.waiting import HANG

pytestmark = pytest.mark.system

EXAMPLE = Path(__file__).parents[2] / "clients" / "examples" / "04_drive_a_robot.py"
RULES = 11
CHECKS = 10  # a driver that gets no turn on a busy machine breaks rules that it keeps when it does


def begun() -> tuple[subprocess.Popen[bytes], subprocess.Popen[bytes]]:
    """Start a check, and the example for it."""
    endpoint = f"tcp/127.0.0.1:{free_ports(1)[0]}"
    # How closely an arm follows on a busy machine is judged by the unit tests, in virtual time.
    words = ["driver-check", "--yes", "--tolerance", "0.05", "--listen", endpoint]
    command = [sys.executable, "-m", "teachpath_client", *words]
    check = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert check.stderr is not None
    assert b"waiting for a driver" in check.stderr.readline()  # it listens from then on
    return check, subprocess.Popen([sys.executable, str(EXAMPLE), "--endpoint", endpoint], stderr=subprocess.DEVNULL)


def test_the_example_keeps_every_rule() -> None:
    said = ""
    for _ in range(CHECKS):
        check, driver = begun()
        try:
            printed, errors = check.communicate(timeout=HANG)
        finally:
            for process in (check, driver):
                process.kill()
                process.wait()
        said = (printed + errors).decode()
        if check.returncode == 0:
            assert said.count("pass  ") == RULES
            return
    pytest.fail(said)
