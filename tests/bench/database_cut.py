"""What a cut between a service and PostgreSQL costs: `python -m tests.bench.database_cut --seconds 10`.

Two services work for one station on one database, one of them over a line that is cut while both do jobs and record.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy import make_url

from teachpath.io.store.pages import PageRequest
from teachpath.live.event_hub import RESYNC_TOPIC, EventHub
from teachpath.records import Job
from tests.contract.job_program import job_service
from tests.postgres import Server, serving
from tests.system.proxy import Proxy
from tests.unit.recorder.recorders import Bench
from tests.unit.recording.hands import demonstration
from tests.waiting import wait_until

SAMPLE_COUNT = 110  # samples of a demonstration
TASK = "lift"
JOBS, REPORTS = 8, 3  # that each service is asked for, and what each of them reports


@dataclass(frozen=True)
class Outcome:
    """What came of a cut.

    Attributes:
        jobs: as they ended.
        runs: ids of those that are stored.
        shown: demonstrations that were shown.
        numbers: of the demonstrations that are stored.
        verdicts: of them.
        faults: what health of the services says in the end.
        true_again: [s] after the line was back, until the page of the service that was cut off was told to read anew.
    """

    jobs: list[Job]
    runs: list[str]
    shown: int
    numbers: list[int]
    verdicts: list[str]
    faults: list[str]
    true_again: float


class Member:
    """One service: its jobs, its recorder, and a page that looks at it."""

    def __init__(self, url: str, folder: Path, role: str) -> None:
        hub = EventHub()
        self.page = hub.subscribe(lambda: None)
        self.store, self.jobs = job_service(url, str(folder), role=role, changed=hub.publish_change)
        self.bench = Bench(self.store)
        self.shown = 0

    def start(self) -> None:
        self.bench.begin(task=TASK)
        self.jobs.start()

    def show(self) -> None:
        """Show the task once more."""
        self.bench.send(demonstration(1 + self.shown * SAMPLE_COUNT))
        self.shown += 1

    def submit(self) -> list[Job]:
        return [self.jobs.submit(TASK, "learn", {"reports": REPORTS}) for _ in range(JOBS)]

    def reads_anew(self) -> bool:
        """Tell whether its page was told to read everything anew, and take all events that wait."""
        topics = set()
        while (event := self.page.pop()) is not None:
            topics.add(event.document["topic"])
        return RESYNC_TOPIC in topics

    def close(self) -> None:
        self.bench.recorder.stop()
        self.jobs.stop()
        self.store.close()


def cut(server: Server, folder: Path, seconds: float) -> Outcome:
    """Cut the line between one of two services and its database for so long, and return what came of it."""
    url = server.new_url()
    with ExitStack() as stack:
        proxy = stack.enter_context(Proxy(server.socket))
        over = make_url(url).set(host="127.0.0.1", port=proxy.port, query={})
        near, far = Member(url, folder / "near", "worker"), Member(str(over), folder / "far", "service")
        members = (near, far)
        for member in members:
            stack.callback(member.close)
            member.start()
        jobs = [job for member in members for job in member.submit()]
        for member in members:
            member.show()
        runs = lambda: [run.id for run in near.store.lists.runs(TASK, PageRequest(limit=500)).entries]  # noqa: E731
        wait_until(runs, "the services work")
        far.reads_anew()
        proxy.drop(cut=True)
        for member in members:
            member.show()
            member.show()
        time.sleep(seconds)
        proxy.go_on()
        back = time.monotonic()
        wait_until(far.reads_anew, "the page is told to read everything anew")
        true_again = time.monotonic() - back
        for member in members:
            member.show()
        ended = lambda: all(near.store.job(job.id).finished_ns for job in jobs)  # noqa: E731
        wait_until(ended, "every job has ended")
        for member in members:
            member.bench.received(member.shown * SAMPLE_COUNT)
            wait_until(lambda member=member: not member.bench.recorder.faults(), "every take has its row")
        made = near.store.demonstrations(TASK)
        return Outcome(
            [near.store.job(job.id) for job in jobs],
            sorted(runs()),
            sum(member.shown for member in members),
            [each.number for each in made],
            [each.verdict for each in made],
            [fault for member in members for fault in member.store.health.faults()],
            true_again,
        )


def main() -> None:
    """Cut the line once and print what came of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=10.0, help="for which the line is cut")
    seconds = parser.parse_args().seconds
    with serving() as server, tempfile.TemporaryDirectory() as folder:
        found = cut(server, Path(folder), seconds)
    states = sorted(job.state for job in found.jobs)
    print(f"cut for {seconds:g} s; the page was told to read anew {found.true_again:.2f} s after the line was back")
    print(f"{len(found.jobs)} jobs: {', '.join(f'{states.count(s)} {s}' for s in sorted(set(states)))}")
    print(f"{len(found.runs)} runs, as the jobs say: {found.runs == sorted(job.outcome for job in found.jobs)}")
    print(f"{found.shown} demonstrations shown, stored {found.numbers}: {', '.join(sorted(set(found.verdicts)))}")
    print(f"health says: {found.faults or 'nothing'}")


if __name__ == "__main__":
    main()
