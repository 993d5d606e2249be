"""The jobs: learning and planning in a process of their own, in order; unfinished ones survive a restart."""

from __future__ import annotations

import queue
import threading
import time
import uuid
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.synchronize import Event
from typing import TYPE_CHECKING, Annotated, Any

from annotated_types import Ge, Le

from teachpath.errors import Cancelled, Conflict, LearningFailed, PathRefused, TeachpathError
from teachpath.io.documents import to_document
from teachpath.io.wire import encode_progress
from teachpath.jobs import worker
from teachpath.jobs.pool import KillablePool
from teachpath.records import Job, JobState
from teachpath_proto.keys import Keys

if TYPE_CHECKING:  # the settings of jobs are read in processes that have no store
    from teachpath.io.bus import Bus
    from teachpath.io.store.store import Store

# A kind of job: `prepare` gathers its input from the store, `work` (a function of `worker`) runs in the other process,
# and `finish` stores the outcome and marks the job succeeded in one transaction.
Prepare = Callable[[Job], tuple[Any, ...]]
Finish = Callable[[Job, Any], str]


@dataclass(frozen=True)
class JobSettings:
    """How background work is done."""

    # how often a job is begun anew after its process died
    attempts: Annotated[int, Ge(1), Le(10)] = 3


@dataclass(frozen=True)
class JobKind:
    """One kind of job."""

    prepare: Prepare
    work: Callable[..., Any]
    finish: Finish


class Jobs:
    """Runs the queued jobs of the store one after another.

    Args:
        kinds: kinds of jobs by their names.
        on_finished: called with each job that has ended.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        store: Store,
        settings: JobSettings,
        kinds: dict[str, JobKind],
        *,
        on_finished: Callable[[Job], None] = lambda job: None,
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._store = store
        self._settings = settings
        self._kinds = kinds
        self._on_finished = on_finished
        self._queue: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        context = get_context("spawn")
        self._progress = context.Queue()
        self._cancel: Event = context.Event()
        self._stopping = threading.Event()
        self._running = ""
        self._pool = KillablePool(worker.init_worker, self._progress, self._cancel)
        self._threads: list[threading.Thread] = []

    def start(self) -> None:
        """Begin to work; jobs that an earlier service left unfinished come first."""
        for job in self._store.jobs(unfinished=True):
            self._queue.put(job.id)
        for run, name in ((self._run, "jobs"), (self._pass_on_progress, "job progress")):
            thread = threading.Thread(target=run, name=name, daemon=True)
            thread.start()
            self._threads.append(thread)
        self._pool.submit(worker.warm_up)

    def stop(self) -> None:
        """Stop at once; a running job stays unfinished in the store and is run again at the next start."""
        self._stopping.set()
        self._cancel.set()
        self._queue.put(None)
        self._progress.put(None)
        self._pool.close()
        for thread in self._threads:
            thread.join(timeout=10.0)
        self._progress.close()
        self._progress.cancel_join_thread()

    def submit(self, task: str, kind: str, request: dict[str, Any]) -> Job:
        """Queue a job and return it."""
        key = f"{kind}-{uuid.uuid4().hex[:12]}"
        job = Job(key, task, kind, request, JobState.QUEUED, 0.0, "", "", 0, time.time_ns(), 0)
        self._store.add_job(job)
        self._queue.put(key)
        return job

    def cancel(self, key: str) -> Job:
        """Cancel a queued or running job; raises Conflict when it has already ended."""
        if self._store.job(key).state is JobState.RUNNING and key == self._running:
            self._cancel.set()
            return self._store.job(key)
        return self._finish(key, JobState.CANCELLED, "cancelled before it began")

    def _run(self) -> None:
        while (key := self._queue.get()) is not None and not self._stopping.is_set():
            try:
                self._process(key)
            except Conflict:
                continue  # cancelled while it was queued
            except Exception as error:  # a fault of one job must not stop the others
                if not self._stopping.is_set():
                    self._finish(key, JobState.FAILED, f"this is a fault of teachpath, please report it: {error!r}")

    def _process(self, key: str) -> None:
        job = self._store.set_job(key, state=JobState.RUNNING.value, attempt=self._store.job(key).attempt + 1)
        if job.attempt > self._settings.attempts:
            self._finish(key, JobState.FAILED, f"its process died {self._settings.attempts} times; is memory short?")
            return
        self._cancel.clear()
        self._running = key
        kind = self._kinds[job.kind]
        try:
            future: Future[Any] = self._pool.submit(worker.work, key, kind.work, kind.prepare(job))
            kind.finish(job, future.result())
            self._announce(self._store.job(key))
        except Cancelled as error:
            if not self._stopping.is_set():
                self._finish(key, JobState.CANCELLED, str(error))
        except TeachpathError as error:
            self._finish(key, JobState.FAILED, str(error), **_evidence(error))
        except BrokenProcessPool:
            if not self._stopping.is_set():
                self._pool.kill()
                self._queue.put(key)
        finally:
            self._running = ""

    def _finish(self, key: str, state: JobState, message: str, **evidence: Any) -> Job:
        job = self._store.set_job(key, state=state.value, message=message, finished_ns=time.time_ns(), **evidence)
        self._announce(job)
        return job

    def _announce(self, job: Job) -> None:
        self._bus.publish(self._keys.job(job.id), encode_progress(job))
        if job.finished_ns:
            self._on_finished(job)

    def _pass_on_progress(self) -> None:
        """Store and publish the progress that the working process reports."""
        while (report := self._progress.get()) is not None:
            key, fraction, message = report
            try:
                job = self._store.set_job(key, fraction=fraction, message=message)
            except Conflict:
                continue  # ended meanwhile
            self._bus.publish(self._keys.job(key), encode_progress(job))


def _evidence(error: TeachpathError) -> dict[str, Any]:
    """Return the records that an error carries, as a job keeps them."""
    if isinstance(error, PathRefused) and error.failure is not None:
        return {"failure": to_document(error.failure)}
    if isinstance(error, LearningFailed):
        return {"demonstration": error.demonstration}
    return {}
