"""A Dask cluster that is away, of other versions, or loses a worker; and the jobs of a service on one."""

import queue
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from distributed import LocalCluster

from teachpath.errors import UnusableSettings
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.jobs.cluster import Cluster
from teachpath.jobs.cluster_executor import ClusterExecutor
from teachpath.jobs.executors import Limits, Work
from teachpath.jobs.settings import JobSettings, check_executor
from teachpath.records import JobState
from tests.contract.job_steps import add, die, hang, linger, refuse, tell, wait_once
from tests.ports import free_ports
from tests.system.proxy import Proxy
from tests.unit.jobs.test_jobs import Bench
from tests.waiting import HANG, wait_until

LIMITS = Limits(0, HANG)


def scheduler(workers: int, port: int = 0) -> LocalCluster:
    return LocalCluster(
        n_workers=workers,
        threads_per_worker=2,
        processes=False,
        protocol="tcp",
        host="127.0.0.1",
        scheduler_port=port,
        dashboard_address="127.0.0.1:0",
    )


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with scheduler(1) as cluster:
        yield cluster.scheduler_address


@contextmanager
def a_worker(address: str) -> Iterator[subprocess.Popen[bytes]]:
    """A worker as somebody begins it on another machine."""
    command = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--no-nanny", "--no-dashboard"]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL, cwd=Path(__file__).parents[2]) as process:
        try:
            yield process
        finally:
            process.kill()


def is_there(process: int) -> bool:
    """Whether a process runs: it may be of nobody's, and then nobody takes its end."""
    stat = Path(f"/proc/{process}/stat")
    try:
        return stat.read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def awaited(reports: "queue.Queue[Any]", words: str) -> None:
    while words not in reports.get(timeout=HANG)[2]:
        pass


def test_a_job_waits_for_the_cluster_and_one_whose_worker_is_lost_is_done_by_another(tmp_path: Path) -> None:
    (port,) = free_ports(1)
    been, released, reports = tmp_path / "been", tmp_path / "released", queue.Queue[Any]()
    cluster = Cluster(f"tcp://127.0.0.1:{port}", reports)
    executor = ClusterExecutor(cluster, LIMITS, reports)
    with ThreadPoolExecutor(1) as thread:
        lost = thread.submit(executor.work, "one", Work(wait_once), (been, released))
        awaited(reports, "does not answer")
        with scheduler(0, port) as local:
            awaited(reports, "no worker has joined the scheduler")
            with a_worker(cluster.address) as process:
                wait_until(been.exists, "the worker has begun the job")
                process.kill()
                with pytest.raises(BrokenProcessPool, match="are gone"):
                    lost.result(HANG)
            wait_until(lambda: not is_there(int(been.read_text())), "the job's process has ended with its worker")
            local.scale(1)
            assert executor.work("one", Work(wait_once), (been, released)) == "again"
            released.touch()
            executor.close()
            cluster.close()


def test_a_job_whose_scheduler_is_lost_waits_for_it_and_is_done_when_it_is_back(address: str, tmp_path: Path) -> None:
    been, released, reports = tmp_path / "been", tmp_path / "released", queue.Queue[Any]()
    with Proxy(int(address.rpartition(":")[2])) as line, ThreadPoolExecutor(1) as thread:
        cluster = Cluster(f"tcp://127.0.0.1:{line.port}", reports)
        executor = ClusterExecutor(cluster, LIMITS, reports)
        lost = thread.submit(executor.work, "one", Work(wait_once), (been, released))
        wait_until(been.exists, "the worker has begun the job")
        line.drop(cut=True)
        awaited(reports, "waits for the cluster: ")
        wait_until(lambda: not is_there(int(been.read_text())), "the job's process has ended")
        line.go_on()
        assert lost.result(HANG) == "again"
        assert executor.work("two", Work(add), (1, 2)) == 3
        awaited(reports, "100% of the sum")
        executor.close()
        cluster.close()


def test_a_job_ends_with_the_service_that_ordered_it(address: str, tmp_path: Path) -> None:
    begun, reports = tmp_path / "begun", queue.Queue[Any]()
    cluster = Cluster(address, reports)
    sent = cluster.submit("one", Work(hang), (begun,), LIMITS)
    wait_until(begun.exists, "the worker has begun the job")
    assert cluster.has_workers(sent)
    assert is_there(int(begun.read_text()))
    cluster.close()  # to the scheduler and the worker the same as a crash: the connection is gone
    wait_until(lambda: not is_there(int(begun.read_text())), "the job's process has ended")


def test_a_worker_of_other_versions_gets_no_job(address: str) -> None:
    reports = queue.Queue[Any]()
    cluster = Cluster(address, reports, {"teachpath": "9.9"})
    executor = ClusterExecutor(cluster, LIMITS, reports)
    with pytest.raises(UnusableSettings, match=r"has teachpath \S+ \(the service: 9.9\); install the same on both"):
        executor.work("one", Work(add), (1,))
    executor.close()
    cluster.close()


def test_jobs_of_a_service_are_done_on_a_cluster_several_at_a_time(address: str, tmp_path: Path) -> None:
    store = Store(StoreSettings(str(tmp_path)))
    settings = JobSettings(executor=address.replace("tcp", "dask"), cluster_jobs=2, attempts=2)
    bench = Bench(store, settings, tell=tell, stay=linger, deny=refuse, die=die)  # type: ignore[arg-type]
    bench.jobs.start()
    lingering = [bench.jobs.submit("t", "stay", {"word": "x"}).id for _ in range(2)]
    wait_until(lambda: [store.job(key).fraction for key in lingering] == [0.5, 0.5], "both report")
    for key in lingering:
        bench.jobs.cancel(key)
    assert {bench.ended.get(timeout=HANG).state for _ in lingering} == {JobState.CANCELLED}
    for kind in ("tell", "deny", "die"):
        bench.jobs.submit("t", kind, {"word": "w"})
    ended = {job.kind: job for job in (bench.ended.get(timeout=HANG) for _ in range(3))}
    assert (ended["tell"].state, ended["tell"].outcome) == (JobState.SUCCEEDED, "w")
    assert (ended["deny"].message, ended["deny"].demonstration) == ("too few", "demonstration-7")
    assert (ended["die"].state, ended["die"].attempt) == (JobState.FAILED, 2)
    assert "its process died 2 times" in ended["die"].message
    bench.jobs.stop()
    store.close()


@pytest.mark.parametrize("executor", ["", "dask", "tcp://a:1", "dask://a", "dask://a b:1", "dask://a:1/path"])
def test_what_is_no_place_for_jobs_is_refused(executor: str) -> None:
    with pytest.raises(UnusableSettings, match="it should be local, or dask://HOST:PORT"):
        check_executor(executor)


@pytest.mark.parametrize("executor", ["local", "dask://head:8786", "dask+tls://[::1]:8786", "dask://10.0.0.1:1"])
def test_what_is_a_place_for_jobs_is_taken(executor: str) -> None:
    check_executor(executor)
