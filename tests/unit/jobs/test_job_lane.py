"""A lane does its jobs in their order, in one process that has begun before the first of them."""

import os
import queue
from collections.abc import Iterator

import pytest

from teachpath.errors import Cancelled
from teachpath.jobs import worker
from teachpath.jobs.executors import Limits, Work
from teachpath.jobs.job_lane import JobLane, Orders
from teachpath.jobs.local_executor import LocalExecutor
from tests.waiting import HANG


def process_id(*, progress: worker.Progress) -> int:
    progress(1.0, "done")
    return os.getpid()


@pytest.fixture
def done() -> queue.SimpleQueue[object]:
    return queue.SimpleQueue()


@pytest.fixture
def orders() -> Orders:
    return queue.SimpleQueue()


@pytest.fixture
def lane(done: queue.SimpleQueue[object], orders: Orders) -> Iterator[JobLane]:
    def process(lane: JobLane, key: str) -> None:
        try:
            done.put((key, lane.work(Work(process_id), ())))
        except Cancelled as error:
            done.put((key, error))

    lane = JobLane("test", LocalExecutor(Limits(0, HANG), queue.SimpleQueue()), process, orders)
    yield lane
    lane.request_stop()
    lane.join()


def test_jobs_are_done_in_their_order_in_one_process(
    lane: JobLane, orders: Orders, done: queue.SimpleQueue[object]
) -> None:
    for key in ("one", "two", "three"):
        orders.put(key)
    lane.start()
    keys, processes = zip(*(done.get(timeout=HANG) for _ in range(3)), strict=True)
    assert keys == ("one", "two", "three")
    assert len(set(processes)) == 1
    assert processes[0] != os.getpid()


def test_a_stopped_lane_begins_no_process(lane: JobLane, orders: Orders, done: queue.SimpleQueue[object]) -> None:
    lane.request_stop()
    orders.put("one")
    lane.start()
    lane.join()
    assert done.empty()
