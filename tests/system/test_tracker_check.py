"""A tracker is checked over a real socket: the client's own keeps every rule, one that others would lose does not."""

import subprocess
import sys

import pytest

from teachpath_client import HandReading, Link, Tracker
from tests.ports import free_ports
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

RULES = 9
READINGS = [HandReading(0.02 * i, (0.5, 0.004 * i, 0.5), buttons=int(10 <= i < 60)) for i in range(70)]


def checked() -> tuple[int, str]:
    """Show something to a check; return how it ended, and what it said."""
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
    return check.returncode, printed + errors


def test_the_client_s_own_tracker_keeps_every_rule() -> None:
    said = ""

    def passes() -> bool:
        nonlocal said
        status, said = checked()
        # A machine that stalls for as long as something is shown leaves nothing to tell the clock's rate by.
        assert status == 0 or said.count("FAIL") == said.count("FAIL  stamps") == 1, said
        return status == 0

    wait_until(passes, "a check on a machine that does not stall")
    assert said.count("pass  ") == RULES
