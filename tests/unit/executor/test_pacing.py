"""Deadlines of a control loop, also of one at rest that something wakes."""

import threading

import numpy as np

from teachpath.executor.pacing import Pacer
from teachpath.time_source import TimeSource

PERIOD = 4_000_000  # ns


def test_a_loop_that_is_woken_at_rest_keeps_its_deadlines_and_begins_with_the_next() -> None:
    rng, now, due = np.random.default_rng(5), 0, 0
    woken, wakes_at = threading.Event(), 0

    def sleep(seconds: float) -> None:
        nonlocal now
        now += round(1e9 * seconds)

    def doze(event: threading.Event, seconds: float) -> None:
        nonlocal now
        if now + 1e9 * seconds > wakes_at > now:
            now = wakes_at
            event.set()
        else:
            sleep(seconds)

    pacer = Pacer(PERIOD, TimeSource(lambda: now, lambda: now, sleep, doze))
    for _ in range(500):
        woken.clear()
        begun, wakes_at = now, now + int(rng.integers(1, 6 * PERIOD))
        before, due = due, pacer.wait(5, counted=False, woken=woken)
        assert due % PERIOD == 0
        assert before + PERIOD <= due <= before + 5 * PERIOD
        assert now == due
        if woken.is_set():
            assert due - PERIOD <= wakes_at < due + 1
        else:
            assert due == before + 5 * PERIOD
        now += int(rng.integers(0, PERIOD // 2))  # the work of a cycle
        assert begun < now
