"""The demo as a user runs it: the whole story, Ctrl-C at any moment, and refusals in one sentence."""

import signal
import socket
from pathlib import Path

import pytest

from teachpath_client import ClientError
from teachpath_client.station import Station
from tests.ports import free_ports
from tests.system.demos import Start, assert_nothing_left, assert_story
from tests.system.processes import Command
from tests.waiting import wait_until

pytestmark = pytest.mark.system


def test_tells_the_whole_story_once_and_leaves_nothing(start: Start) -> None:
    demo = start("--once", "--speed", "10")
    assert demo.wait() == 0, demo.err
    assert_story(demo.out)
    assert "Traceback" not in demo.err
    assert_nothing_left(demo)


def test_tells_it_with_an_arm_from_a_model(start: Start) -> None:
    demo = start("--once", "--speed", "10", "--arm", "seven-axis")
    assert demo.wait() == 0, demo.err
    assert_story(demo.out)
    assert_nothing_left(demo)


@pytest.mark.parametrize("signalled", ["Ctrl-C in a terminal", "SIGINT to the command alone"])
def test_ctrl_c_in_the_middle_of_recording_ends_everything(start: Start, signalled: str) -> None:
    demo = start("--speed", "4", port=(port := free_ports(1)[0]))
    wait_until(lambda: demo.process.poll() or recorded(port), "a demonstration is recorded")
    assert any("teachpath_client" in line for line in demo.relatives())
    if signalled == "Ctrl-C in a terminal":
        demo.interrupt()
    else:
        demo.process.send_signal(signal.SIGINT)
    assert demo.wait() == 1
    assert_nothing_left(demo)
    assert "stopped by the operator" in demo.err
    assert "Traceback" not in demo.err


def recorded(port: int) -> int:
    """Return how many demonstrations the demo at `port` has recorded so far."""
    try:
        with Station(f"http://127.0.0.1:{port}") as station:
            return len(station.demonstrations("demo"))
    except ClientError:
        return 0


def assert_refused(demo: Command, sentence: str) -> None:
    assert demo.wait() == 1
    assert demo.out == ""
    assert demo.err.splitlines()[-1].startswith("teachpath: ")
    assert sentence in demo.err
    assert "Traceback" not in demo.err
    assert_nothing_left(demo)


def test_a_taken_web_port_is_said(start: Start) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert_refused(start("--once", port=port), f"cannot listen on 127.0.0.1:{port}")


def test_recordings_that_are_not_there_are_said(start: Start, tmp_path: Path) -> None:
    assert_refused(start("--once", "--recordings", str(tmp_path / "none.npy")), "none.npy")


def test_recordings_that_are_cut_off_are_said(start: Start, tmp_path: Path) -> None:
    torn = tmp_path / "torn.npy"
    torn.write_bytes(b"\x93NUMPY\x01\x00v\x00{'descr': '<f8', 'fortran_order': False, 'shape': (9, 100, 7), }")
    assert_refused(start("--once", "--recordings", str(torn)), "torn.npy: not a whole file of format robottasks")
