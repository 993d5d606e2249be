"""Processes that are started again when they die, with real processes."""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from teachpath.robot.processes import MAX_DEATHS, SupervisedProcess
from tests.waiting import wait_until

Supervise = Callable[..., SupervisedProcess]
LISTEN = "import sys; sys.stdin.readline(); sys.stdin.read()"  # lives until its standard input is closed


@pytest.fixture
def causes() -> list[str]:
    return []


@pytest.fixture
def supervise(causes: list[str]) -> Iterator[Supervise]:
    started: list[SupervisedProcess] = []

    def start(program: str, *arguments: str) -> SupervisedProcess:
        command = (sys.executable, "-c", program, *arguments)
        started.append(
            SupervisedProcess("executor", command, "{}", suggestion="look at the arm", on_death=causes.append)
        )
        started[-1].start()
        return started[-1]

    yield start
    for process in started:
        process.stop()
        assert not process.is_alive()


def living(process: SupervisedProcess) -> int:
    wait_until(process.is_alive, "it lives")
    assert process._process is not None
    return process._process.pid


def test_a_killed_process_is_started_again_and_a_note_names_cause_and_suggestion(
    supervise: Supervise, causes: list[str]
) -> None:
    process = supervise(LISTEN)
    first = living(process)
    assert (process.note(), process.state) == ("", "running")
    os.kill(first, signal.SIGKILL)
    wait_until(lambda: process.is_alive() and living(process) != first, "another process lives")
    assert causes == ["killed by signal 9, Killed"]
    assert process.note() == "the executor died (killed by signal 9, Killed) and was started again; look at the arm"


def test_what_dies_again_and_again_is_given_up_with_its_error(supervise: Supervise, causes: list[str]) -> None:
    process = supervise(
        "import logging, sys; logging.basicConfig(level=logging.INFO); logging.info('begins'); "
        "sys.stderr.write('ValueError: no such arm\\n'); logging.info('ends'); sys.exit(3)"
    )
    wait_until(lambda: len(causes) == MAX_DEATHS, "it has died often")
    wait_until(lambda: "is not started again" in process.note(), "it is given up")
    assert set(causes) == {"exit status 3: ValueError: no such arm"}
    assert process.note().endswith("(exit status 3: ValueError: no such arm); mend the cause, then restart the service")
    assert process.state == "ended"


def test_what_follows_a_death_may_fail_and_the_process_is_started_again_all_the_same(tmp_path: Path) -> None:
    def fail(cause: str) -> None:
        raise RuntimeError(cause)

    program = "import sys; open(sys.argv[1], 'a').write('x')"
    command = (sys.executable, "-c", program, str(tmp_path / "starts"))
    process = SupervisedProcess("executor", command, "{}", suggestion="look at the arm", on_death=fail)
    process.start()
    wait_until(lambda: process.is_given_up, "it has died often")
    process.stop()
    assert (tmp_path / "starts").read_text() == "x" * MAX_DEATHS


def test_a_process_that_is_stopped_stays_stopped(supervise: Supervise, causes: list[str], tmp_path: Path) -> None:
    process = supervise(f"import sys; open(sys.argv[1], 'a').write('started\\n'); {LISTEN}", str(tmp_path / "starts"))
    wait_until((tmp_path / "starts").exists, "it has started")
    process.stop()
    process.stop()
    assert not process.is_alive()
    assert causes == []
    assert process.note() == ""
    assert (tmp_path / "starts").read_text() == "started\n"


def test_a_process_that_ignores_its_end_is_killed(supervise: Supervise, tmp_path: Path) -> None:
    process = supervise(
        "import signal, sys, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); open(sys.argv[1], 'w'); "
        "time.sleep(600)",
        str(tmp_path / "begun"),
    )
    wait_until((tmp_path / "begun").exists, "it ignores its end")
    process.stop()
    assert not process.is_alive()
