"""The jobs: learning, planning and files in processes of their own, in order; unfinished ones survive a restart."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from dataclasses import dataclass
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, Final

from teachpath.errors import Cancelled, Conflict, NotFound, QueueFull, StorageUnavailable, TeachpathError
from teachpath.io.wire import encode_progress
from teachpath.jobs.executors import Work
from teachpath.jobs.idempotency import begun_by, job_id
from teachpath.jobs.job_faults import disk_sentence, evidence_of
from teachpath.jobs.job_lane import JobLane
from teachpath.jobs.lanes import LaneName, Lanes
from teachpath.jobs.settings import JobSettings
from teachpath.jobs.shared_jobs import OwnJobs, SharedJobs
from teachpath.logs import continue_request, request_number
from teachpath.records import Job, JobKindName, JobState
from teachpath_proto.keys import Keys

if TYPE_CHECKING:  # the settings of jobs are read in processes that have no store
    from teachpath.io.bus import Bus
    from teachpath.io.store.store import Store

log: logging.Logger = logging.getLogger("teachpath")

LOG_PART: Final = "worker"  # of the station, in the log: the service tells what its working processes do
STORE_INTERVAL: Final = 1.0  # [s] after which a job is tried again that the store could not take

# A kind of job: `prepare` gathers its input from the store, `work` runs in another process, and `finish` stores the
# outcome and marks the job succeeded in one transaction.
Prepare = Callable[[Job], tuple[Any, ...]]
Finish = Callable[[Job, Any], str]


@dataclass(frozen=True)
class JobKind:
    """One kind of job.

    Attributes:
        lane: where it is done; jobs of one lane wait for each other.
        clean_up: called when a job has ended, however it did.
    """

    prepare: Prepare
    work: Work
    finish: Finish
    lane: LaneName = "learning"
    clean_up: Callable[[Job], None] = lambda job: None


class Jobs:
    """Runs the queued jobs of the store, those of each lane one after another.

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
        self._progress: SimpleQueue[tuple[str, float, str] | None] = SimpleQueue()
        self._lanes = Lanes(settings, self._progress, self._run)
        self._lock = threading.Lock()
        self._requests: dict[str, str] = {}  # numbers of the requests that queued the unfinished jobs
        self._submitters: dict[str, str] = {}  # of the unfinished jobs: who submitted them
        self._queued: set[str] = set()  # ids that wait in a lane
        own = OwnJobs(
            list(kinds),
            self._lanes.running,
            self._lanes.cancel,
            self._enqueue,
            self._on_changed_elsewhere,
            self._forget_ended,
        )
        self._shared = SharedJobs(store, own)
        self._reporter = threading.Thread(target=self._pass_on_progress, name="job progress", daemon=True)

    def start(self) -> None:
        """Begin to work; jobs that an earlier service left unfinished come first."""
        for job in self._store.jobs(unfinished=True):
            self._submitters[job.id] = ""
            if job.kind in self._kinds:
                self._enqueue(job)
        self._reporter.start()
        self._shared.start()
        self._lanes.start()

    def stop(self) -> None:
        """Stop at once; a running job waits in the store for the next start, or for another service."""
        self._shared.stop()
        under_way = self._lanes.running()
        self._lanes.stop()
        with suppress(StorageUnavailable):
            self._store.claims.give_back(under_way)
        self._progress.put(None)
        if self._reporter.ident is not None:
            self._reporter.join(timeout=10.0)

    def require_room(self, submitter: str) -> None:
        """Raise QueueFull when no further job of a submitter can be queued."""
        with self._lock:
            waiting, own = len(self._submitters), list(self._submitters.values()).count(submitter)
        for count, limit, whose, setting in (
            (waiting, self._settings.max_queued, "jobs wait or run", "max_queued"),
            (own, self._settings.max_queued_by_one, f"jobs of {submitter} wait or run", "max_queued_by_one"),
        ):
            if count >= limit:
                raise QueueFull(
                    f"{count} {whose}, limit {limit} (jobs.{setting}); wait until one has ended, or cancel some"
                )

    def submit(
        self,
        task: str,
        kind: JobKindName,
        request: dict[str, Any],
        submitter: str = "",
        *,
        who: str = "",
        idempotency_key: str = "",
    ) -> Job:
        """Queue a job and return it.

        Args:
            task: that it is of.
            kind: of work.
            request: what that kind takes.
            submitter: whose jobs are counted together.
            who: ordered it, for whoever reads of it.
            idempotency_key: of the order; the job that it has begun before is returned.

        Raises:
            QueueFull: too many jobs wait, or too many of this submitter.
            Conflict: the key is of another order, or the task is archived.
        """
        if known := begun_by(self._store, task, kind, request, submitter, idempotency_key):
            return known
        with suppress(NotFound):  # an import makes its task
            self._store.open_task(task)
        self.require_room(submitter)
        key = job_id(task, kind, submitter, idempotency_key)
        station, now = self._store.services.station, time.time_ns()
        job = Job(key, task, kind, request, JobState.QUEUED, 0.0, "", "", 0, now, 0, who=who, station=station)
        with self._lock:
            self._submitters[key], self._requests[key] = submitter, request_number()
        try:
            self._store.add_job(job)
        except BaseException:
            if known := begun_by(self._store, task, kind, request, submitter, idempotency_key):
                return known  # the same order came at the same time
            self._forget(key)
            raise
        self._enqueue(job)
        return job

    def cancel(self, key: str) -> Job:
        """Cancel a queued or running job; raises Conflict when it has already ended."""
        job = self._store.job(key)
        if job.state is JobState.RUNNING and self._lanes.cancel(key):
            return self._store.job(key)
        cancelled = self._store.claims.cancel(key)
        if cancelled.finished_ns:
            self._announce(cancelled)
        return cancelled

    def _enqueue(self, job: Job) -> None:
        with self._lock:
            if job.id in self._queued or job.id in self._lanes.running():
                return
            self._queued.add(job.id)
        self._lanes.put(self._kinds[job.kind].lane, job.id)

    def _on_changed_elsewhere(self, key: str) -> None:
        """Pass on what another service has done with a job of this station, and do what it leaves."""
        job = self._store.job(key)
        if job.station != self._store.services.station or job.kind not in self._kinds:
            return
        if job.state is JobState.QUEUED:
            self._enqueue(job)
        if key in self._submitters or not job.finished_ns:
            self._announce(job)

    def _forget_ended(self) -> None:
        unfinished = {job.id for job in self._store.jobs(unfinished=True)}
        for key in set(self._submitters) - unfinished:
            self._forget(key)

    def _forget(self, key: str) -> str:
        """Return the number of the request that queued a job, which counts no longer."""
        with self._lock:
            self._submitters.pop(key, None)
            return self._requests.pop(key, "")

    def _run(self, lane: JobLane, key: str) -> None:
        self._queued.discard(key)
        continue_request(self._requests.get(key, ""))
        try:
            self._process(lane, key)
        except Conflict:
            return  # it was ended, or taken up, by another service
        except StorageUnavailable as error:
            log.warning("job %s waits for the store: %s", key, error)
            if not lane.wait_for_stop(STORE_INTERVAL):
                lane.put(key)
        except Exception as error:  # a fault of one job must not stop the others
            if not lane.is_stopping:
                self._finish(key, JobState.FAILED, f"this is a fault of teachpath, please report it: {error!r}")

    def _process(self, lane: JobLane, key: str) -> None:
        job = self._store.claims.claim(key)
        if job is None:
            return  # it was cancelled while it was queued, or another service does it
        log.info("%s begins", key, extra={"part": LOG_PART})
        kind = self._kinds[job.kind]
        try:
            kind.finish(job, lane.work(kind.work, kind.prepare(job)))
            self._announce(self._store.job(key))
        except Cancelled as error:
            if not lane.is_stopping:
                self._finish(key, JobState.CANCELLED, str(error))
        except StorageUnavailable:
            raise
        except TeachpathError as error:
            self._finish(key, JobState.FAILED, str(error), **evidence_of(error))
        except OSError as error:
            self._finish(key, JobState.FAILED, disk_sentence(error))
        except BrokenProcessPool:
            if not lane.is_stopping:
                self._count_crash(lane, job)

    def _count_crash(self, lane: JobLane, job: Job) -> None:
        """Queue a job again whose process died; only that counts as an attempt, and no restart of the service does."""
        if job.attempt >= self._settings.attempts:
            self._finish(job.id, JobState.FAILED, f"its process died {job.attempt} times; is memory short?")
        else:
            self._store.set_job(job.id, attempt=job.attempt + 1)
            lane.put(job.id)

    def _finish(self, key: str, state: JobState, message: str, **evidence: Any) -> Job:
        job = self._store.set_job(key, state=state.value, message=message, finished_ns=time.time_ns(), **evidence)
        self._announce(job)
        return job

    def _announce(self, job: Job) -> None:
        if job.finished_ns:
            request = self._forget(job.id)
            said = job.outcome or job.message
            log.info("%s %s: %s", job.id, job.state, said, extra={"part": LOG_PART, "request": request})
            self._kinds[job.kind].clean_up(job)
        self._bus.publish(self._keys.job(job.id), encode_progress(job))
        if job.finished_ns:
            self._on_finished(job)

    def _pass_on_progress(self) -> None:
        """Store and publish the progress that the working process reports."""
        while (report := self._progress.get()) is not None:
            key, fraction, message = report
            try:
                job = self._store.set_job(key, fraction=fraction, message=message)
            except (Conflict, StorageUnavailable):
                continue  # ended meanwhile; or the next report is stored
            self._bus.publish(self._keys.job(key), encode_progress(job))
