"""Jobs on services that are killed again and again, none lost and none doubled: `python -m tests.bench.job_kills`."""

from __future__ import annotations

import argparse
import queue
import random
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from contextlib import ExitStack
from pathlib import Path

from teachpath.io.store.pages import PageRequest
from teachpath.io.store.services import DEAD_AFTER
from teachpath.io.store.store import Store
from tests.contract.job_program import job_service
from tests.contract.rows import a_job
from tests.postgres import serving
from tests.waiting import HANG, wait_until

TASK = "lift"
REPORTS = 15  # of each job, 20 ms apart
# Of the time that a service takes to start, between two kills, at least and at most: the process of its jobs takes as
# long again, however busy the machine is, and one of four lives for four kills.
PAUSE = 0.1, 1.0
STUCK_TIMEOUT = 2 * DEAD_AFTER + HANG  # [s] without any job that ends


class Program:
    """A service in a process of its own, which is started anew after each kill."""

    def __init__(self, url: str, folder: Path) -> None:
        self._command = [sys.executable, "-m", "tests.contract.job_program", url, str(folder)]
        self._start()

    def _start(self) -> None:
        self._process = subprocess.Popen(self._command, stdout=subprocess.PIPE, text=True)
        self._began, self._started = time.monotonic(), queue.SimpleQueue[float]()
        self.start_seconds = 0.0  # that it took; 0: it has not said yet that it works
        self._reader = threading.Thread(target=self._read, args=(self._process, self._started), daemon=True)
        self._reader.start()

    def _read(self, process: subprocess.Popen[str], started: queue.SimpleQueue[float]) -> None:
        assert process.stdout is not None
        with process.stdout:
            if process.stdout.readline():
                started.put(time.monotonic())

    def has_started(self) -> bool:
        """Tell whether it has said that it works."""
        assert self._process.poll() is None, "a service has ended by itself"
        if not self._started.empty():
            self.start_seconds = self._started.get() - self._began
        return self.start_seconds > 0.0

    def kill(self) -> None:
        self._process.kill()
        self._process.wait()
        self._reader.join()

    def kill_and_restart(self) -> None:
        self.kill()
        self._start()


def kill_until_done(store: Store, programs: list[Program], chance: random.Random) -> int:
    """Kill services that have said that they work, until all jobs have ended; return how often."""
    wait_until(lambda: all(program.has_started() for program in programs), "every service works")
    kills, left, since = 0, len(store.jobs(unfinished=True)), time.monotonic()
    pause = max(program.start_seconds for program in programs)
    while unfinished := store.jobs(unfinished=True):
        if len(unfinished) < left:
            left, since = len(unfinished), time.monotonic()
        elif time.monotonic() - since > STUCK_TIMEOUT:
            sys.exit(f"no job has ended for {STUCK_TIMEOUT:g} s, {left} are left: {unfinished[:3]}")
        time.sleep(pause * chance.uniform(*PAUSE))
        if started := [program for program in programs if program.has_started()]:
            chosen = chance.choice(started)
            pause = chosen.start_seconds
            chosen.kill_and_restart()
            kills += 1
    return kills


def main() -> None:
    """Kill services while they do jobs, and print what became of every job."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--jobs", type=int, default=200)
    parser.add_argument("--services", type=int, default=4)
    parser.add_argument("--seed", type=int, default=1)
    wanted = parser.parse_args()
    began = time.monotonic()
    with serving() as server, tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        url = server.new_url()
        store, jobs = job_service(url, str(Path(folder) / "asked"))  # which does none of them
        stack.callback(store.close)
        stack.callback(jobs.stop)
        store.ensure_task(TASK, scene="paper", calibration="identity")
        programs = [Program(url, Path(folder) / str(number)) for number in range(wanted.services)]
        for program in programs:
            stack.callback(program.kill)
        begun = [a_job(f"learn-{n}", task=TASK, request={"reports": REPORTS}) for n in range(wanted.jobs)]
        for job in begun:
            store.add_job(job)
        kills = kill_until_done(store, programs, random.Random(wanted.seed))
        ended = [store.job(job.id) for job in begun]
        runs = sorted(run.id for run in store.lists.runs(TASK, PageRequest(limit=500)).entries)
    states = Counter(job.state.value for job in ended)
    print(f"{wanted.jobs} jobs on {wanted.services} services, {kills} kills, {time.monotonic() - began:.0f} s")
    print(f"ended: {dict(states)}; {len(runs)} runs")
    print(f"each run is that of one job: {runs == sorted(job.outcome for job in ended)}")
    if set(states) != {"succeeded"} or runs != sorted(job.outcome for job in ended):
        sys.exit("a job was lost or done twice")


if __name__ == "__main__":
    main()
