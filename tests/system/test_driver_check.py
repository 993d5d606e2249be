"""Drivers are checked over real sockets: the simulated arm and the example keep every rule."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.ports import free_ports
from tests.waiting import HANG

pytestmark = pytest.mark.system

EXAMPLE = Path(__file__).parents[2] / "clients" / "examples" / "04_drive_a_robot.py"
DRIVERS = {
    "the simulated arm": [sys.executable, "-m", "teachpath", "simulator"],
    "the example": [sys.executable, str(EXAMPLE), "--endpoint"],
}
RULES = 9
CHECKS = 10  # of one driver; a driver that gets no turn on a busy machine breaks rules that it keeps when it does


def begun(driver: Sequence[str]) -> tuple[subprocess.Popen[bytes], subprocess.Popen[bytes]]:
    """Start a check, and a driver for it."""
    endpoint = f"tcp/127.0.0.1:{free_ports(1)[0]}"
    # How closely an arm follows on a busy machine is judged by the unit tests, in virtual time.
    words = ["driver-check", "--yes", "--tolerance", "0.05", "--listen", endpoint]
    command = [sys.executable, "-m", "teachpath_client", *words]
    check = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert check.stderr is not None
    assert b"waiting for a driver" in check.stderr.readline()  # it listens from then on
    environment = {**os.environ, "TEACHPATH_BUS__ENDPOINT": endpoint}
    named = [*driver, endpoint] if driver[-1] == "--endpoint" else driver
    return check, subprocess.Popen(named, env=environment, stderr=subprocess.DEVNULL)


def test_the_simulated_arm_and_the_example_keep_every_rule() -> None:
    unproved = dict(DRIVERS)
    said: dict[str, str] = {}
    for _ in range(CHECKS):
        running = {name: begun(driver) for name, driver in unproved.items()}
        try:
            for name, (check, _driver) in running.items():
                printed, errors = check.communicate(timeout=HANG)
                said[name] = (printed + errors).decode()
                if check.returncode == 0:
                    assert said[name].count("pass  ") == RULES
                    del unproved[name]
        finally:
            for process in (process for pair in running.values() for process in pair):
                process.kill()
                process.wait()
        if not unproved:
            return
    pytest.fail("\n".join(f"{name}:\n{said[name]}" for name in unproved))
