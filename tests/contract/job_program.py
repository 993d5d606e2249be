"""A service that does jobs, as a program that can be killed: `python -m tests.contract.job_program URL FOLDER`."""

import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.changes import Changed, unheard
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.jobs.executors import Work
from teachpath.jobs.jobs import JobKind, Jobs
from teachpath.jobs.settings import JobSettings
from teachpath.records import Job, Learned
from teachpath_proto.keys import Keys
from tests.contract.rows import learned

PAUSE = 0.02  # [s] between two reports of a job that works


def learn(reports: int, *, progress: Callable[[float, str], None]) -> Learned:
    for number in range(reports):
        progress(number / reports, f"step {number}")
        time.sleep(PAUSE)
    return learned()


def job_service(
    url: str, folder: str, *, station: str = "cell", role: str = "worker", changed: Changed = unheard
) -> tuple[Store, Jobs]:
    """Open a service whose jobs report as often as they are asked to; it is still to be started."""
    store = Store(StoreSettings(folder, url, station), changed=changed)
    store.services.begin(role)

    def prepare(job: Job) -> tuple[Any, ...]:
        return (job.request["reports"],)

    kinds = {"learn": JobKind(prepare, Work(learn), lambda job, made: store.finish_learning(job.id, made))}
    return store, Jobs(MemoryBus(), Keys("test"), store, JobSettings(), kinds)


if __name__ == "__main__":
    service, work = job_service(*sys.argv[1:])
    work.start()
    print(service.services.id, flush=True)
    threading.Event().wait()
