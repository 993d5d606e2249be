"""Processes that are started again when they die, with real processes."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest

from teachpath.robot.processes import MAX_DEATHS, SupervisedProcess
from tests.waiting import HANG, wait_until

Supervise = Callable[..., SupervisedProcess]
LISTEN = "import sys; sys.stdin.readline(); sys.stdin.read()"  # lives until its standard input is closed

LOSS = """
import os, signal, time
from functools import partial
from pathlib import Path
from teachpath.robot.processes import SupervisedProcess

def of(pid):
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()

def wait_for(true):
    while not true():
        time.sleep(0.01)

if __name__ == "__main__":
    causes = []
    process = SupervisedProcess(
        "executor", partial(exec, "import sys; sys.stdin.read()", {}), "", suggestion="", on_death=causes.append
    )
    process.start()
    wait_for(process.is_alive)
    first = process._process.pid
    os.kill(int(of(first)[1]), signal.SIGKILL)
    wait_for(lambda: process.is_alive() and process._process.pid != first)
    wait_for(lambda: not Path(f"/proc/{first}").exists() or of(first)[0] == "Z")  # until init waits for it
    print(*causes)
    process.stop()
"""


@pytest.fixture
def causes() -> list[str]:
    return []


@pytest.fixture
def supervise(causes: list[str]) -> Iterator[Supervise]:
    started: list[SupervisedProcess] = []

    def start(program: str, **names: str) -> SupervisedProcess:
        function = partial(exec, program, dict(names))
        started.append(
            SupervisedProcess("executor", function, "{}", suggestion="look at the arm", on_death=causes.append)
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

    function = partial(exec, "open(file, 'a').write('x')", {"file": str(tmp_path / "starts")})
    process = SupervisedProcess("executor", function, "{}", suggestion="look at the arm", on_death=fail)
    process.start()
    wait_until(lambda: process.is_given_up, "it has died often")
    process.stop()
    assert (tmp_path / "starts").read_text() == "x" * MAX_DEATHS


def test_a_process_that_is_stopped_stays_stopped(supervise: Supervise, causes: list[str], tmp_path: Path) -> None:
    starts = tmp_path / "starts"
    process = supervise(f"open(file, 'a').write('started\\n'); {LISTEN}", file=str(starts))
    wait_until(lambda: starts.exists() and starts.read_text(), "it has started")  # the file is there before its words
    process.stop()
    process.stop()
    assert not process.is_alive()
    assert causes == []
    assert process.note() == ""
    assert starts.read_text() == "started\n"


def test_a_process_that_ignores_its_end_is_killed(supervise: Supervise, tmp_path: Path) -> None:
    process = supervise(
        "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); open(file, 'w'); time.sleep(600)",
        file=str(tmp_path / "begun"),
    )
    wait_until((tmp_path / "begun").exists, "it ignores its end")
    process.stop()
    assert not process.is_alive()


def test_what_has_lost_the_server_that_it_was_forked_from_ends_and_is_started_again(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(LOSS)
    done = subprocess.run([sys.executable, str(program)], capture_output=True, text=True, timeout=HANG, check=False)
    assert (done.returncode, done.stdout) == (0, "the process server ended, which it was forked from\n"), done.stderr
