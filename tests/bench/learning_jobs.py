"""How soon learning jobs are answered: the first one of a station that has just started, and later ones."""

import tempfile
import time
from functools import partial
from pathlib import Path

from teachpath_client import Station
from teachpath_client.models import Job
from tests.bench.motion import show, timed_job
from tests.bench.report import Figure, against
from tests.system.processes import Service
from tests.waiting import wait_until

DEMONSTRATION_COUNT = 12  # demonstrations of the synthetic hand
LATER_JOBS = 5  # jobs after the first one of each start
POLL = 0.01  # [s]
FIRST_LIMIT, LATER_LIMIT = 1.0, 0.2  # [s]


def measure(*, starts: int) -> list[Figure]:
    """Return the figures of so many starts of a station, in processes of its own, that has twelve demonstrations.

    The first job is asked for as soon as the station answers. Jobs are asked after every `POLL` seconds only: asked at
    once again, service and client would take the processor from what they wait for.
    """
    beginnings, first, later = [], [], []
    with tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder:
        data = Path(folder) / "data"
        with Service(data) as service:
            show(service.endpoint)
            wait_until(partial(_is_shown, service.station), "everything shown is stored")
        for _ in range(starts):
            began = time.perf_counter()
            with Service(data) as service:
                beginnings.append(time.perf_counter() - began)
                taken = [
                    timed_job(service.station, partial(_learn, service.station), poll=POLL)[1]
                    for _ in range(1 + LATER_JOBS)
                ]
                first.append(taken[0])
                later += taken[1:]
    return [
        Figure("start of a station, command to first answer", tuple(beginnings), "s"),
        against("learning job, asked for at that moment, POST to outcome", first, "s", name="limit", value=FIRST_LIMIT),
        against("learning job in a warm worker, POST to outcome", later, "s", name="limit", value=LATER_LIMIT),
    ]


def _is_shown(station: Station) -> bool:
    return len(station.demonstrations("demo")) == DEMONSTRATION_COUNT


def _learn(station: Station) -> Job:
    return station.begin_job("demo", "learn")
