"""What every executor of jobs does, on the process of this machine and on a Dask cluster of one worker."""

import os
import queue
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import pytest
from distributed import LocalCluster

from teachpath.errors import Cancelled, LearningFailed, OverLimit
from teachpath.jobs.cluster import open_cluster
from teachpath.jobs.cluster_executor import ClusterExecutor
from teachpath.jobs.executors import JobExecutor, Limits, Work
from teachpath.jobs.local_executor import LocalExecutor
from tests.contract.job_steps import add, devour, die_once, fault, hang, linger, negated, refuse, with_process
from tests.waiting import HANG, wait_until

MEMORY = 256 * 2**20


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    with LocalCluster(
        n_workers=1,
        threads_per_worker=2,
        processes=False,
        protocol="tcp",
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",
    ) as cluster:
        yield cluster.scheduler_address


@pytest.fixture
def reports() -> Any:
    return queue.Queue()


@pytest.fixture(params=["local", "cluster"])
def executor(request: pytest.FixtureRequest, reports: Any) -> Iterator[JobExecutor]:
    limits = Limits(MEMORY, HANG)
    if request.param == "local":
        made: JobExecutor = LocalExecutor(limits, reports)
        yield made
        made.close()
        return
    cluster = open_cluster(request.getfixturevalue("scheduler").replace("tcp://", "dask://"), reports)
    assert cluster is not None
    made = ClusterExecutor(cluster, limits, reports)
    yield made
    made.close()
    cluster.close()


def test_the_outcome_comes_back_and_the_progress_in_its_order(executor: JobExecutor, reports: Any) -> None:
    executor.begin()
    assert executor.work("one", Work(add), (1, 2, 3)) == 6
    assert [reports.get(timeout=HANG) for _ in range(3)] == [
        ("one", 0.25, "25% of the sum"),
        ("one", 0.5, "50% of the sum"),
        ("one", 1.0, "100% of the sum"),
    ]


def test_what_is_loaded_and_concluded_frames_the_work(executor: JobExecutor) -> None:
    made, numbers, process = executor.work("one", Work(add, negated, with_process), (1, 2))
    assert (made, numbers) == (-3, (1, 2))
    assert process != os.getpid()


def test_a_refusal_comes_back_with_what_it_carries_and_a_fault_as_it_is(executor: JobExecutor) -> None:
    with pytest.raises(LearningFailed, match="too few") as refused:
        executor.work("one", Work(refuse), ())
    assert refused.value.demonstration == "demonstration-7"
    with pytest.raises(ZeroDivisionError, match="boom"):
        executor.work("two", Work(fault), ())


def test_the_job_after_one_whose_process_died_is_done(executor: JobExecutor, tmp_path: Path) -> None:
    been = tmp_path / "been"
    with pytest.raises(BrokenProcessPool):
        executor.work("one", Work(die_once), (been,))
    assert executor.work("one", Work(die_once), (been,)) == "alive"


@pytest.mark.skipif(sys.platform != "linux", reason="the system cannot limit what a process takes from now on")
def test_a_job_over_the_limit_of_memory_is_refused_and_the_next_one_is_done(executor: JobExecutor) -> None:
    with pytest.raises(OverLimit, match=f"needs over {MEMORY} bytes of memory, the limit"):
        executor.work("one", Work(devour), ())
    assert executor.work("two", Work(add), (1,)) == 1


@pytest.mark.parametrize("reporting", [True, False])
def test_a_cancelled_job_ends_whether_it_reports_or_hangs_and_the_next_one_is_done(
    executor: JobExecutor, reports: Any, tmp_path: Path, reporting: bool
) -> None:
    begun = tmp_path / "begun"
    with ThreadPoolExecutor(1) as thread:
        working = thread.submit(
            executor.work, "one", Work(linger if reporting else hang), () if reporting else (begun,)
        )
        if reporting:
            assert reports.get(timeout=HANG)[0] == "one"
        else:
            wait_until(begun.exists, "the job has begun")
        executor.cancel()
        with pytest.raises(Cancelled, match="cancelled by the operator"):
            working.result(HANG)
    executor.renew()
    assert executor.work("two", Work(add), (1,)) == 1


def test_a_job_that_is_cancelled_before_it_begins_does_not_begin(executor: JobExecutor, tmp_path: Path) -> None:
    executor.renew()
    executor.cancel()
    with pytest.raises(Cancelled):
        executor.work("one", Work(linger), ())


def test_closing_ends_the_job_under_way(executor: JobExecutor, tmp_path: Path) -> None:
    begun, ended = tmp_path / "begun", threading.Event()

    def work() -> None:
        with pytest.raises((Cancelled, BrokenProcessPool)):
            executor.work("one", Work(hang), (begun,))
        ended.set()

    thread = threading.Thread(target=work)
    thread.start()
    wait_until(begun.exists, "the job has begun")
    executor.close()
    assert ended.wait(HANG)
    thread.join()
