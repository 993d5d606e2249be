"""Real executors that are stopped or killed in mid-motion, on random paths: `python -m tests.bench.stopped_executors`.

`lateness` shows the same in a time of its own; here executor, simulated arm and service are processes, on a bus of
sockets. What the arm did is read from the recording of each execution. As many moments are struck in all as are asked
for; half of the executors are stopped for 20 to 500 ms, half are killed.
"""

import argparse
import os
import signal
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np

from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.motion.arm.model import Arm
from teachpath.records import Fit, LearnedPath
from teachpath.robot.processes import MAX_DEATHS
from teachpath_client.errors import Refused
from teachpath_client.models import Execution
from tests.bench.lateness import DONE_OFF, SLEEPS, random_plans
from tests.bench.report import Figure, against, machine, print_report
from tests.contract.rows import a_job, learned
from tests.plan_checker.random_cases import random_case
from tests.system.processes import Service
from tests.system.test_lateness import executor, motion_of, off_path
from tests.waiting import HANG, wait_until

ARM = Arm.of_variant()
SERVICE_MOMENTS = 2 * (MAX_DEATHS - 1)  # of one service, which starts no executor again that dies too often


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Stop and kill executors while the arm moves.")
    parser.add_argument("--paths", type=int, default=10, help="random paths (%(default)s)")
    parser.add_argument("--moments", type=int, default=10, help="executions on each of them (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="of the moments (%(default)s)")
    asked = parser.parse_args()
    print(f"{asked.paths} paths, {asked.moments} moments each, seed {asked.seed}; {machine()}", flush=True)
    figures = measure(paths=asked.paths, moments=asked.moments, seed=asked.seed)
    print_report("Real executors stopped for 20 to 500 ms, or killed", figures)


def measure(*, paths: int, moments: int, seed: int) -> list[Figure]:
    """Return the figures of so many executions on each of so many random paths, for each of both disturbances."""
    rng = np.random.default_rng(seed)
    found: dict[str, list[tuple[float, float, float, bool]]] = {"stopped": [], "killed": []}
    with tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder:
        data = Path(folder) / "data"
        tasks = _store_paths(data, paths)
        for task in tasks:
            for first in range(0, moments, SERVICE_MOMENTS):
                with Service(data) as service:
                    (run,) = service.station.runs(task)
                    plan = service.station.plan(run.paths[0]).id
                    for number in range(first, min(first + SERVICE_MOMENTS, moments)):
                        kind = ("stopped", "killed")[number % 2]
                        found[kind].append(_struck(service, plan, rng, is_killed=kind == "killed"))
    return [figure for kind, cases in found.items() for figure in _figures(kind, cases)]


def _store_paths(data: Path, count: int) -> list[str]:
    """Store random paths, each learned in a task of its own with a scene of its own; returns the tasks."""
    store = Store(StoreSettings(data_dir=str(data)))
    tasks = []
    for seed, _ in islice(random_plans(), count):  # those that can be planned
        curve, scene = random_case(seed)
        name = f"random-{seed}"
        store.scenes.save(replace(scene, name=name), None)
        store.ensure_task(name, scene=name, calibration="identity")
        store.add_job(a_job(f"learn-{seed}", kind="learn", task=name))
        outcome, path = learned(), LearnedPath(name, name, 1, 1, curve, Fit(0.0, 0.0, 0.0, 0.0))
        store.finish_learning(f"learn-{seed}", replace(outcome, clusters=outcome.clusters[:1], paths=(path,)))
        tasks.append(name)
    store.close()
    return tasks


def _struck(
    service: Service, plan: str, rng: np.random.Generator, *, is_killed: bool
) -> tuple[float, float, float, bool]:
    """Strike the executor once in mid-motion; returns how far off the path the arm was [m], its use of the limits of
    speed and torque, and whether it came to rest as it should."""
    station = service.station
    execution = _begun(service, plan)
    wait_until(lambda: station.get_execution(execution.id).status.cycles > 0, "the arm moves")
    pid = executor(service)
    time.sleep(rng.uniform(0.0, 2.0))
    os.kill(pid, signal.SIGKILL if is_killed else signal.SIGSTOP)
    if not is_killed:
        time.sleep(rng.uniform(*SLEEPS))
        os.kill(pid, signal.SIGCONT)
    ended = station.wait(execution, timeout=HANG)
    time.sleep(1.0)  # in which the arm follows its way to rest
    motion = motion_of(service, execution.id)
    speed = max(float(np.max(np.abs(s.velocity) / ARM.limits.speed)) for s in motion.states)
    torque = max(float(np.max(np.abs(s.torque) / ARM.limits.torque)) for s in motion.states)
    at_rest = float(np.abs(motion.states[-1].velocity).max()) < 0.01
    return off_path(motion), speed, torque, at_rest and (is_killed or ended.status.state == "ended")


def _begun(service: Service, plan: str) -> Execution:
    """Begin as soon as the executor, which may have been started again, and the arm are there."""

    def begun() -> Execution | None:
        try:
            service.station.wait_for_arm(timeout=HANG)
            return service.station.begin_execution(plan)
        except Refused:
            return None

    execution = wait_until(begun, "the executor begins")
    assert execution is not None
    return execution


def _figures(kind: str, cases: Sequence[tuple[float, float, float, bool]]) -> list[Figure]:
    off, speed, torque, rested = zip(*cases, strict=True)
    return [
        Figure(
            f"{len(cases)} executors {kind}: arms not at rest where they should be", (float(rested.count(False)),), ""
        ),
        against("  the arm does off the path", [1e3 * each for each in off], "mm", name="asked", value=1e3 * DONE_OFF),
        against("  use of speed by what the arm does", list(speed), "", name="limit", value=1.0),
        against("  use of torque by what the arm does", list(torque), "", name="limit", value=1.0),
    ]


if __name__ == "__main__":
    main()
