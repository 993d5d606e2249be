import logging
import os
import queue
import signal
import struct
import time
from collections.abc import Iterator
from concurrent.futures import CancelledError
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import active_children
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import pytest

from teachpath.jobs.pool import KillablePool
from teachpath.logs import continue_request
from tests.waiting import HANG, wait_until


def name_process(name: str) -> None:
    os.environ["POOL_NAME"] = name


def process_name() -> str:
    return os.environ["POOL_NAME"]


def hang(begun: Path) -> None:
    begun.touch()
    time.sleep(HANG)


def die() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def tell(what: str) -> None:
    logging.getLogger("teachpath.work").info(what)


class Reports:
    """Where a process of a pool reports to."""

    writer: Connection

    @classmethod
    def begin(cls, writer: Connection) -> None:
        cls.writer = writer

    @classmethod
    def report(cls, what: Any) -> None:
        cls.writer.send(what)

    @classmethod
    def die_in_a_report(cls) -> None:
        os.write(cls.writer.fileno(), struct.pack("!i", 100) + b"half of it")
        die()


@pytest.fixture
def pool() -> Iterator[KillablePool]:
    pool = KillablePool(name_process, "one")
    yield pool
    pool.close()


def test_calls_run_in_one_process_that_was_initialized(pool: KillablePool) -> None:
    pids = {pool.submit(os.getpid).result(HANG) for _ in range(3)}
    assert len(pids) == 1
    assert pids != {os.getpid()}
    assert pool.submit(process_name).result(HANG) == "one"


def test_a_stuck_call_is_killed_and_the_next_one_gets_another_process(pool: KillablePool, tmp_path: Path) -> None:
    before = pool.submit(os.getpid).result(HANG)
    begun = tmp_path / "begun"
    stuck, waiting = pool.submit(hang, begun), [pool.submit(process_name) for _ in range(5)]
    wait_until(begun.exists, "the call begins")
    pool.kill()
    with pytest.raises(BrokenProcessPool):
        stuck.result(HANG)
    with pytest.raises((BrokenProcessPool, CancelledError)):
        waiting[-1].result(HANG)
    assert pool.submit(os.getpid).result(HANG) != before
    assert pool.submit(process_name).result(HANG) == "one"


def test_after_its_process_died_a_pool_works_again_once_it_was_killed(pool: KillablePool) -> None:
    with pytest.raises(BrokenProcessPool):
        pool.submit(die).result(HANG)
    pool.kill()
    assert pool.submit(process_name).result(HANG) == "one"


def test_a_closed_pool_starts_no_process(pool: KillablePool) -> None:
    pid = pool.submit(os.getpid).result(HANG)
    pool.close()
    with pytest.raises(BrokenProcessPool, match="closed"):
        pool.submit(process_name)
    assert pid not in {child.pid for child in active_children()}


def test_a_kill_spares_the_processes_of_others(pool: KillablePool) -> None:
    other = KillablePool(name_process, "other")
    try:
        spared = other.submit(os.getpid).result(HANG)
        killed = pool.submit(os.getpid).result(HANG)
        pool.kill()
        pool.kill()
        alive = {child.pid for child in active_children()}
        assert spared in alive
        assert killed not in alive
        assert other.submit(process_name).result(HANG) == "other"
    finally:
        other.kill()


def test_ctrl_c_reaches_no_process_of_the_pool_from_its_first_moment(pool: KillablePool) -> None:
    assert signal.SIGINT in pool.submit(signal.pthread_sigmask, signal.SIG_BLOCK, ()).result()
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def test_what_a_process_logs_stands_in_the_log_of_the_service_under_its_request(
    pool: KillablePool, caplog: pytest.LogCaptureFixture
) -> None:
    for number, what in (("one", "begun"), ("two", "goes on")):
        continue_request(number)
        pool.submit(tell, what).result(HANG)
    continue_request("")
    pool.kill()  # what was written is passed on all the same
    wait_until(lambda: len(said(caplog)) == 2, "both lines are there")
    assert said(caplog) == [("worker", "one", "begun"), ("worker", "two", "goes on")]


def test_what_a_process_reports_comes_in_its_order_also_after_one_was_killed_in_the_middle_of_a_report() -> None:
    heard = queue.Queue[Any]()
    pool = KillablePool(Reports.begin, on_report=heard.put)
    try:
        for number in range(3):
            pool.submit(Reports.report, ("one", number))
        assert [heard.get(timeout=HANG) for _ in range(3)] == [("one", 0), ("one", 1), ("one", 2)]
        with pytest.raises(BrokenProcessPool):
            pool.submit(Reports.die_in_a_report).result(HANG)
        pool.kill()
        pool.submit(Reports.report, ("two", 0))
        assert heard.get(timeout=HANG) == ("two", 0)
    finally:
        pool.close()


def said(caplog: pytest.LogCaptureFixture) -> list[tuple[str, str, str]]:
    own = [record for record in caplog.records if record.name == "teachpath.work"]
    return [(vars(record)["part"], vars(record)["request"], record.getMessage()) for record in own]
