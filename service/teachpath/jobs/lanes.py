"""The lanes of jobs: one for files, and as many for learning and planning as are worked on at a time."""

from __future__ import annotations

import queue
from collections.abc import Callable
from typing import Literal

from teachpath.jobs.cluster import Cluster, open_cluster
from teachpath.jobs.cluster_executor import ClusterExecutor
from teachpath.jobs.executors import JobExecutor, Limits, Reports
from teachpath.jobs.job_lane import JobLane, Orders
from teachpath.jobs.local_executor import LocalExecutor
from teachpath.jobs.settings import JobSettings

LaneName = Literal["learning", "files"]


class Lanes:
    """All lanes of a service.

    Args:
        settings: where jobs are worked on, and what they may take.
        progress: receives their reports: key, fraction, sentence.
        process: does the job of a key on its lane.

    Raises:
        UnusableSettings: a cluster is named, and what speaks to it is not installed.
    """

    def __init__(self, settings: JobSettings, progress: Reports, process: Callable[[JobLane, str], None]) -> None:
        learning = Limits(settings.max_memory, settings.max_duration)
        files = Limits(settings.max_file_memory, settings.max_file_duration)
        self._cluster: Cluster | None = open_cluster(settings.executor, progress)
        local: list[JobExecutor] = [LocalExecutor(learning, progress)]
        executors = [
            ClusterExecutor(self._cluster, learning, progress) for _ in range(settings.cluster_jobs) if self._cluster
        ]
        orders: dict[LaneName, Orders] = {"learning": queue.SimpleQueue(), "files": queue.SimpleQueue()}
        self._orders = orders
        self._lanes = [JobLane("learning", each, process, orders["learning"]) for each in executors or local]
        self._lanes.append(JobLane("files", LocalExecutor(files, progress), process, orders["files"]))

    def start(self) -> None:
        """Begin to work."""
        for lane in self._lanes:
            lane.start()

    def stop(self) -> None:
        """Stop at once, even in the middle of jobs."""
        for lane in self._lanes:
            lane.request_stop()
        for lane in self._lanes:
            lane.join()
        if self._cluster:
            self._cluster.close()

    def put(self, lane: LaneName, key: str) -> None:
        """Queue a job."""
        self._orders[lane].put(key)

    def running(self) -> list[str]:
        """Return the keys of the jobs that run."""
        return [key for lane in self._lanes if (key := lane.running)]

    def cancel(self, key: str) -> bool:
        """Cancel a job if it runs; return whether it does."""
        doing = [lane for lane in self._lanes if lane.running == key]
        for lane in doing:
            lane.cancel()
        return bool(doing)
