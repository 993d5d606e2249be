import os
import signal
import time
from collections.abc import Iterator

import pytest

from teachpath.errors import NotFound, OverLimit, Unreachable
from teachpath.jobs.limited_process import LimitedProcess
from teachpath.jobs.settings import JobSettings


@pytest.fixture
def process() -> Iterator[LimitedProcess]:
    process = LimitedProcess(JobSettings())
    yield process
    process.stop()


def die() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def refuse(what: str) -> None:
    raise NotFound(f"recording {what} is missing")


def fill(size: int) -> int:
    return len(bytearray(size))


def test_a_call_returns_or_raises_what_the_function_does_elsewhere(process: LimitedProcess) -> None:
    first = process.call(os.getpid)
    assert first != os.getpid()
    with pytest.raises(NotFound, match=r"recording a\.mcap is missing"):
        process.call(refuse, "a.mcap")
    assert process.call(os.getpid) == first


def test_after_a_death_the_next_call_has_another_process(process: LimitedProcess) -> None:
    first = process.call(os.getpid)
    with pytest.raises(Unreachable, match="try again"):
        process.call(die)
    assert process.call(os.getpid) != first


def test_what_takes_too_much_memory_or_time_is_refused(process: LimitedProcess) -> None:
    with pytest.raises(OverLimit, match=r"jobs\.max_file_memory"):
        process.call(fill, 2**31)
    hasty = LimitedProcess(JobSettings(max_file_duration=0.01))
    with pytest.raises(OverLimit, match=r"jobs\.max_file_duration"):
        hasty.call(time.sleep, 3600.0)
    hasty.stop()


def test_after_the_stop_no_process_starts(process: LimitedProcess) -> None:
    process.stop()
    with pytest.raises(Unreachable):
        process.call(os.getpid)
