import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import pytest

from teachpath.realtime import (
    EXECUTOR_PRIORITY,
    MESSAGE_PRIORITY,
    NICE,
    SIMULATOR_PRIORITY,
    realtime_threads,
    request_realtime,
    set_inherited_fifo,
)

T = TypeVar("T")


def refuse(_: int) -> None:
    raise PermissionError(1, "Operation not permitted")


def grant(_: int) -> None:
    return None


def test_what_is_granted_is_said() -> None:
    asked: list[int] = []
    assert request_realtime(40, fifo=asked.append, nice=refuse) == "real-time scheduling SCHED_FIFO 40"
    assert asked == [40]


@pytest.mark.parametrize(("nice", "words"), [(grant, f"but nice {NICE}"), (refuse, "shares the processor")])
def test_a_refusal_falls_back_to_nice_and_says_how_to_allow_it(nice: Callable[[int], None], words: str) -> None:
    said = request_realtime(40, fifo=refuse, nice=nice)
    assert said.startswith("no real-time scheduling ([Errno 1] Operation not permitted)")
    assert words in said
    assert "rtprio 40` in /etc/security/limits.conf" in said
    assert "LimitRTPRIO=40" in said
    assert "\n" not in said


def test_a_system_without_either_is_no_error() -> None:
    def missing(_: int) -> None:
        raise AttributeError("sched_setscheduler")

    assert "no real-time scheduling" in request_realtime(40, fifo=missing, nice=missing)


def in_new_thread(function: Callable[[], T]) -> T:
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(function).result()


def scheduling() -> tuple[int, int]:
    return os.sched_getscheduler(0), os.sched_getparam(0).sched_priority


def scheduled(wanted: bool, fifo: Callable[[int], None] = set_inherited_fifo) -> list[tuple[int, int]]:
    """Return how threads are scheduled: one before, one that starts meanwhile, one that this one starts, one later."""

    def ask() -> list[tuple[int, int]]:
        before = scheduling()
        with realtime_threads(wanted, fifo=fifo):
            meanwhile = in_new_thread(lambda: [scheduling(), in_new_thread(scheduling)])
        return [before, *meanwhile, scheduling()]

    return in_new_thread(ask)


def test_threads_that_are_started_meanwhile_run_before_ordinary_ones_but_not_before_the_loops() -> None:
    granted = in_new_thread(lambda: request_realtime(MESSAGE_PRIORITY)).startswith("real-time scheduling")
    ordinary = in_new_thread(scheduling)
    first = (os.SCHED_FIFO, MESSAGE_PRIORITY) if granted else ordinary
    assert scheduled(wanted=True) == [ordinary, first, first, ordinary]
    assert scheduled(wanted=False) == [ordinary] * 4
    assert MESSAGE_PRIORITY < SIMULATOR_PRIORITY < EXECUTOR_PRIORITY


def test_a_refusal_leaves_them_ordinary() -> None:
    assert len(set(scheduled(wanted=True, fifo=refuse))) == 1
