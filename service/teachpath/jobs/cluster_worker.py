"""What runs in a worker of a Dask cluster: the work in a process of its own, with the limits of the station's settings.

The service sends these functions by their names, so that a worker needs teachpath in the same version.
"""

from __future__ import annotations

import multiprocessing
import platform
import threading
from collections import deque
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Any, Final

from distributed import Status, Worker, get_worker

from teachpath.errors import Cancelled
from teachpath.jobs.cluster import DAEMON
from teachpath.jobs.executors import Limits, Work
from teachpath.jobs.local_executor import LocalExecutor
from teachpath.process_server import start_process_server

COMPARED_PACKAGES: Final = ("teachpath", "distributed", "numpy", "scipy", "numba", "hmmlearn", "ruckig", "mujoco-core")
PRELOADED_MODULES: Final = (
    "teachpath.offline.learning_job",
    "teachpath.learning.relearn",
    "teachpath.motion.planning.plan",
)

LOOK_INTERVAL: Final = 1.0  # [s] between two looks at whether somebody still waits for the outcome
CLOSED_STATUSES: Final = (
    Status.closing,
    Status.closed,
    Status.failed,
)  # of a worker whose scheduler is lost, too

_lock: Final = threading.Lock()
_running: Final[dict[str, LocalExecutor]] = {}
_cancelled: Final[deque[str]] = deque(maxlen=1000)  # of the service's orders, which may come after their cancellation


@dataclass(frozen=True)
class EventReports:
    """Sends reports to the service that listens to a topic."""

    worker: Worker
    topic: str

    def put(self, report: tuple[str, float, str]) -> None:
        """Send a report."""
        self.worker.log_event(self.topic, list(report))


def versions() -> dict[str, str]:
    """Return the versions that service and worker have to share."""
    found = {"Python": ".".join(platform.python_version_tuple()[:2])}
    for name in COMPARED_PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "none"
    return found


def examine() -> dict[str, str]:
    """Return the versions of this worker; DAEMON where it may not begin the processes that jobs are done in."""
    return DAEMON if multiprocessing.current_process().daemon else versions()


def work_in_limits(order: str, work: Work, inputs: tuple[Any, ...], limits: Limits, topic: str) -> Any:
    """Do the middle step of a job for an order of a service, while that is there; raises as `LocalExecutor.work`."""
    start_process_server(PRELOADED_MODULES)
    worker, ended = get_worker(), threading.Event()

    def end_with_service() -> None:
        while not ended.wait(LOOK_INTERVAL):
            if not _is_wanted(worker, order):
                executor.close()

    executor = LocalExecutor(limits, EventReports(worker, topic))
    watcher = threading.Thread(target=end_with_service, name="job watch", daemon=True)
    watcher.start()
    try:
        with _lock:
            if order in _cancelled:
                raise Cancelled("cancelled by the operator")
            _running[order] = executor
        return executor.work(order, work, inputs)
    finally:
        ended.set()
        with _lock:
            _running.pop(order, None)
        watcher.join()
        executor.close()


def _is_wanted(worker: Worker, order: str) -> bool:
    """Whether the scheduler is there, and waits for an order: it lets go of those of a service that has gone."""
    task = worker.state.tasks.get(order)
    return worker.status not in CLOSED_STATUSES and task is not None and task.state in ("executing", "long-running")


def cancel(order: str) -> None:
    """Cancel an order here, and when it comes later."""
    with _lock:
        _cancelled.append(order)
        executor = _running.get(order)
    if executor:
        executor.cancel()
