"""Jobs worked on in a Dask cluster, one at a time; what only this machine can read or sign is done here."""

from __future__ import annotations

import threading
from concurrent.futures.process import BrokenProcessPool
from typing import Any, Final

from teachpath.errors import Cancelled
from teachpath.jobs import worker
from teachpath.jobs.cluster import Cluster, ClusterAway, Sent, new_order
from teachpath.jobs.executors import Limits, Reports, Work
from teachpath.jobs.local_executor import LocalExecutor

POLL_INTERVAL: Final = 0.1  # [s] between two looks at whether a job was cancelled
LOOK_INTERVAL: Final = 2.0  # [s] between two looks at whether workers are left, and at a cluster that was away


class ClusterExecutor:
    """Sends jobs to a cluster and waits for their outcome; those that it cannot send wait for it.

    A job whose worker is lost is done again by another worker, by Dask itself; where none is left, it counts as one
    whose process died.

    Args:
        cluster: shared with other executors.
        limits: of each job, held by the worker.
        progress: receives the reports: key of the job, fraction, sentence.
    """

    def __init__(self, cluster: Cluster, limits: Limits, progress: Reports) -> None:
        self._cluster, self._limits, self._progress = cluster, limits, progress
        self._local = LocalExecutor(limits, progress)
        self._cancelled = threading.Event()
        self._closed = threading.Event()

    def begin(self) -> None:
        """Do nothing: the cluster is asked when there is a job, and may be away until then."""

    def renew(self) -> None:
        """Forget that the job before was cancelled."""
        self._cancelled.clear()
        self._local.renew()

    def cancel(self) -> None:
        """Cancel the job under way, or the next one."""
        self._cancelled.set()
        self._local.cancel()

    def close(self) -> None:
        """Stop at once, even in the middle of a job; no other is begun."""
        self._closed.set()
        self._cancelled.set()
        self._local.close()

    def work(self, key: str, work: Work, inputs: tuple[Any, ...]) -> Any:
        """Return the outcome of a job; see `JobExecutor.work`."""
        loaded = self._local.work(key, Work(worker.call), (work.load, *inputs)) if work.load else inputs
        made = self._work_far(key, work, loaded)
        return self._local.work(key, Work(worker.call), (work.conclude, made, *inputs)) if work.conclude else made

    def _work_far(self, key: str, work: Work, inputs: tuple[Any, ...]) -> Any:
        while True:
            try:
                return self._await(self._cluster.submit(new_order(key), work, inputs, self._limits))
            except ClusterAway as away:
                self._progress.put((key, 0.0, f"waits for the cluster: {away}"))
            if self._is_cancelled(LOOK_INTERVAL):
                raise Cancelled("cancelled by the operator")

    def _await(self, sent: Sent) -> Any:
        from distributed import KilledWorker

        ended, looks = threading.Event(), 0
        sent.future.add_done_callback(lambda _: ended.set())
        while not ended.wait(POLL_INTERVAL):
            if self._is_cancelled(0.0):
                self._cluster.cancel(sent)
                raise Cancelled("cancelled by the operator")
            looks += 1
            if looks % int(LOOK_INTERVAL / POLL_INTERVAL) == 0 and not self._cluster.has_workers(sent):
                self._cluster.cancel(sent)
                raise BrokenProcessPool("the workers that it was sent to are gone")
        if sent.future.cancelled():
            raise ClusterAway("its scheduler was lost")
        try:
            return sent.future.result()
        except KilledWorker as error:
            raise BrokenProcessPool(str(error)) from None

    def _is_cancelled(self, seconds: float) -> bool:
        return self._cancelled.wait(seconds) or self._closed.is_set()
