"""The periodic thread; only its upper bounds of time are real, so that a busy machine passes too."""

import logging
import threading

import pytest

from teachpath.periodic_thread import PeriodicThread
from tests.waiting import HANG

LONG_PERIOD = 3600.0  # [s] longer than any test


def test_it_calls_until_it_is_stopped_and_can_be_started_again() -> None:
    calls = threading.Semaphore(0)
    thread = PeriodicThread("test", 0.001, calls.release)
    for _ in range(2):
        assert not thread.is_running
        thread.start()
        assert thread.is_running
        assert all(calls.acquire(timeout=HANG) for _ in range(3))
        thread.stop()
        thread.stop()
        while calls.acquire(blocking=False):  # what was called before the stop
            pass
    assert not calls.acquire(timeout=0.01)


def test_it_pauses_before_the_first_call_and_a_stop_cuts_the_pause_short() -> None:
    calls: list[int] = []
    thread = PeriodicThread("test", LONG_PERIOD, lambda: calls.append(1))
    thread.start()
    thread.stop()
    assert calls == []


def test_a_call_that_returns_true_is_followed_without_a_pause() -> None:
    calls, enough = 0, threading.Event()

    def action() -> bool:
        nonlocal calls
        calls += 1
        if calls == 1000:
            enough.set()
        return calls < 1000

    thread = PeriodicThread("test", 1.0, action)
    thread.start()
    assert enough.wait(HANG)  # with its pauses it would take 1000 s
    thread.stop()


def test_a_stop_waits_for_the_call_that_is_under_way() -> None:
    begun, go_on, ended = threading.Event(), threading.Event(), threading.Event()

    def action() -> None:
        begun.set()
        go_on.wait(HANG)
        ended.set()

    thread = PeriodicThread("test", 0.001, action)
    thread.start()
    assert begun.wait(HANG)
    threading.Timer(0.01, go_on.set).start()
    thread.stop()
    assert ended.is_set()


def test_an_error_is_logged_once_in_a_row_and_does_not_end_the_calls(caplog: pytest.LogCaptureFixture) -> None:
    calls, enough = 0, threading.Event()

    def action() -> None:
        nonlocal calls
        calls += 1
        if calls > 6:
            enough.set()
        elif calls != 4:  # twice three failures in a row
            raise OSError("the disk is full")

    thread = PeriodicThread("flusher", 0.001, action)
    with caplog.at_level(logging.ERROR, "teachpath"):
        thread.start()
        assert enough.wait(HANG)
        thread.stop()
    assert [record.message for record in caplog.records] == ["flusher failed; trying again every 0.001 s"] * 2
