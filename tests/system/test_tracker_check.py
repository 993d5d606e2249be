"""A tracker is checked over a real socket: the client's own keeps every rule, one that others would lose does not."""

import subprocess
import sys

import pytest

from teachpath_client import HandReading, Link, Tracker
from tests.ports import free_ports
from tests.waiting import HANG

pytestmark = pytest.mark.system

RULES = 9
READINGS = [HandReading(0.02 * i, (0.5, 0.004 * i, 0.5), buttons=int(10 <= i < 60)) for i in range(70)]


def test_the_client_s_own_tracker_keeps_every_rule() -> None:
    endpoint = f"tcp/127.0.0.1:{free_ports(1)[0]}"
    command = [sys.executable, "-m", "teachpath_client", "tracker-check", "--listen", endpoint]
    check = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert check.stderr is not None
    assert "waiting for a tracker" in check.stderr.readline()  # it listens from then on
    try:
        with Link(endpoint) as link:
            tracker = Tracker(link, "mine")
            tracker.start("stack")
            tracker.publish(READINGS)
            tracker.stop()
        printed, errors = check.communicate(timeout=HANG)
    finally:
        check.kill()
    assert check.returncode == 0, printed + errors
    assert printed.count("pass  ") == RULES
