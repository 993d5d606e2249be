"""The connection to a Dask cluster: its workers, whose versions are compared, orders, and their reports."""

from __future__ import annotations

import logging
import threading
import uuid
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Final

from teachpath.errors import UnusableSettings
from teachpath.jobs.executors import Limits, Reports, Work
from teachpath.jobs.settings import LOCAL_EXECUTOR

if TYPE_CHECKING:  # of an extra
    from distributed import Client, Future

log: logging.Logger = logging.getLogger("teachpath")

CONNECT_TIMEOUT: Final = 5.0  # [s]
ANSWER_TIMEOUT: Final = 10.0  # [s] in which scheduler and workers answer questions
DAEMON: Final = {"daemon": "yes"}  # answer of a worker that may begin no processes


class ClusterAway(Exception):
    """The scheduler does not answer, or no worker has joined it; the text says which."""


def open_cluster(executor: str, progress: Reports) -> Cluster | None:
    """Return the cluster of a setting `jobs.executor`, None where jobs are done locally.

    Raises:
        UnusableSettings: what speaks to it is not installed.
    """
    if executor == LOCAL_EXECUTOR:
        return None
    if find_spec("distributed") is None:
        raise UnusableSettings("jobs on a Dask cluster need distributed: pip install 'teachpath[dask]'")
    return Cluster(executor.replace("dask+tls://", "tls://").replace("dask://", "tcp://"), progress)


@dataclass(frozen=True)
class Sent:
    """An order that was sent: its name, its outcome, and the addresses of the workers that may do it."""

    order: str
    future: Future[Any]
    workers: frozenset[str]


class Cluster:
    """A scheduler and its workers; it is connected to when the first job needs it, and anew when it was away.

    Args:
        address: of the scheduler, as Dask writes it.
        progress: receives the reports of jobs: key, fraction, sentence.
        versions: that workers have to have; None: those of this process.
    """

    def __init__(self, address: str, progress: Reports, versions: Mapping[str, str] | None = None) -> None:
        self._progress, self._versions = progress, versions
        self.address: str = address
        self._lock = threading.Lock()
        self._client: Client | None = None
        self._refused: set[str] = set()  # sentences about workers that were logged

    def submit(self, order: str, work: Work, inputs: tuple[Any, ...], limits: Limits) -> Sent:
        """Send the middle step of a job to the workers that have the versions of this service.

        Raises:
            ClusterAway: nobody is there now.
            UnusableSettings: none of the workers has them.
        """
        from teachpath.jobs import cluster_worker

        try:
            client = self._connected()
            fit = self._fit_workers(client)
            arguments = (order, Work(work.function), inputs, limits, _topic(client))
            future = client.submit(cluster_worker.work_in_limits, *arguments, key=order, workers=fit, pure=False)
            return Sent(order, future, frozenset(fit))
        except (OSError, TimeoutError) as error:
            raise ClusterAway(f"the scheduler at {self.address} does not answer ({error})") from None

    def has_workers(self, sent: Sent) -> bool:
        """Whether one of the workers that an order was sent to is there.

        Raises:
            ClusterAway: the scheduler is away, and the order with it.
        """
        try:
            client = sent.future.client
            there = client.sync(client.scheduler.ncores, callback_timeout=ANSWER_TIMEOUT)
            return not sent.workers.isdisjoint(there)
        except (OSError, TimeoutError) as error:
            raise ClusterAway(f"the scheduler at {self.address} does not answer ({error})") from None

    def cancel(self, sent: Sent) -> None:
        """Cancel an order wherever it is, or will be."""
        from teachpath.jobs import cluster_worker

        with suppress(OSError, TimeoutError):  # who is away does nothing, and gets nothing new
            self._run(sent.future.client, cluster_worker.cancel, sent.order)
            sent.future.cancel()

    def close(self) -> None:
        """Leave the cluster."""
        with self._lock:
            self._leave()

    def _connected(self) -> Client:
        from distributed import Client

        with self._lock:
            if self._client is None or self._client.status != "running":
                self._leave()
                self._client = Client(self.address, timeout=CONNECT_TIMEOUT, set_as_default=False, name="teachpath")
            # Always: the scheduler may have been lost, and the client have come back by itself, without the reports.
            self._client.subscribe_topic(_topic(self._client), self._report)
            return self._client

    def _leave(self) -> None:
        client, self._client = self._client, None
        if client is not None:
            with suppress(OSError, TimeoutError):  # it was lost
                client.close(timeout=CONNECT_TIMEOUT)

    def _report(self, event: tuple[float, Any]) -> None:
        order, fraction, sentence = event[1]
        self._progress.put((job_of(order), fraction, sentence))

    def _fit_workers(self, client: Client) -> list[str]:
        """Return the addresses of the workers that have the versions of this service; raises as `submit`."""
        from teachpath.jobs import cluster_worker

        ours = self._versions or cluster_worker.versions()
        faults, fit = {}, []
        for address, theirs in self._run(client, cluster_worker.examine).items():
            if fault := _fault(ours, theirs):
                faults[address] = fault
            else:
                fit.append(address)
        for address, fault in faults.items():
            if (sentence := f"the worker at {address} gets no jobs: {fault}") not in self._refused:
                self._refused.add(sentence)
                log.warning("%s", sentence)
        if not fit and faults:
            address, fault = next(iter(faults.items()))
            raise UnusableSettings(f"no worker of the cluster at {self.address} can do it; that at {address} {fault}")
        if not fit:
            raise ClusterAway(f"no worker has joined the scheduler at {self.address}")
        return fit

    def _run(self, client: Client, function: Callable[..., Any], *arguments: Any) -> dict[str, Any]:
        """Call a function in every worker and return what it returned, by address; raises OSError, TimeoutError."""
        answers: dict[str, Any] = client.run(function, *arguments, on_error="return", callback_timeout=ANSWER_TIMEOUT)
        return {address: answer for address, answer in answers.items() if not isinstance(answer, OSError)}


def new_order(job: str) -> str:
    """Return a name for an attempt at a job."""
    return f"{job} {uuid.uuid4().hex}"


def job_of(order: str) -> str:
    """Return the key of the job of an order."""
    return order.partition(" ")[0]


def _topic(client: Client) -> str:
    return f"teachpath {client.id}"


def _fault(ours: Mapping[str, str], theirs: dict[str, str] | Exception) -> str:
    """Say why a worker gets no orders, with the way out; empty: it does."""
    if isinstance(theirs, Exception):
        return (
            f"cannot tell its versions ({theirs!r}); install there: pip install 'teachpath[dask]=={ours['teachpath']}'"
        )
    if theirs == DAEMON:
        return (
            "may begin no processes, in which jobs are done: begin it with `dask worker --no-nanny`, or with "
            "DASK_DISTRIBUTED__WORKER__DAEMON=False"
        )
    others = [
        f"{name} {theirs.get(name)} (the service: {version})"
        for name, version in ours.items()
        if theirs.get(name) != version
    ]
    if not others:
        return ""
    return f"has {', '.join(others)}; install the same on both, then begin the worker anew"
