"""Drivers are checked over real sockets: the simulated arm and the example keep every rule."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.system.processes import free_ports
from tests.waiting import HANG

pytestmark = pytest.mark.system

EXAMPLE = Path(__file__).parents[2] / "clients" / "examples" / "04_drive_a_robot.py"
SIMULATOR = [sys.executable, "-m", "teachpath", "simulator"]
RULES = 9


def test_the_simulated_arm_and_the_example_keep_every_rule() -> None:
    endpoints = [f"tcp/127.0.0.1:{port}" for port in free_ports(2)]
    commands = [SIMULATOR, [sys.executable, str(EXAMPLE), "--endpoint", endpoints[1]]]
    # How closely an arm follows on a busy machine is judged by the unit tests, in virtual time.
    check = [sys.executable, "-m", "teachpath_client", "driver-check", "--yes", "--tolerance", "0.05", "--listen"]
    checks = [subprocess.Popen([*check, each], stdout=subprocess.PIPE, stderr=subprocess.PIPE) for each in endpoints]
    drivers = []
    try:
        for running, command, endpoint in zip(checks, commands, endpoints, strict=True):
            assert running.stderr is not None
            assert b"waiting for a driver" in running.stderr.readline()  # it listens from then on
            environment = {**os.environ, "TEACHPATH_BUS__ENDPOINT": endpoint}
            drivers.append(subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL))
        for running in checks:
            printed, said = running.communicate(timeout=HANG)
            assert running.returncode == 0, printed.decode() + said.decode()
            assert printed.decode().count("pass  ") == RULES
    finally:
        for each in (*checks, *drivers):
            each.kill()
            each.wait()
