"""A served station: job round trips, and the executor's lateness and the arm's tracking error on real executions."""

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from statistics import median

from teachpath.commands.serving import free_port, serving
from teachpath.config import load
from teachpath_client import Station
from teachpath_client.errors import NotInTime
from teachpath_client.models import ExecutorStatus, Job
from tests.bench import idle, teleoperation
from tests.bench.busy import learner_and_page
from tests.bench.report import Figure, against

POLL = 0.002  # [s]
LONGEST_ADAPTATION = 0.5  # [s]


def measure(*, repeats: int, seconds: float) -> list[Figure]:
    """Return the figures; an execution is stopped after `seconds`, or runs to its end.

    An execution that the executor gives up is a figure too, with what was measured until then.
    """
    with tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder:
        endpoint = f"tcp/127.0.0.1:{free_port()}"
        places = {"web": {"port": free_port()}, "bus": {"endpoint": endpoint}, "store": {"data_dir": folder}}
        settings = load(document=places)
        with serving(settings), Station(f"http://127.0.0.1:{settings.web.port}") as station:
            show(endpoint)
            figures, plan = _jobs(station, repeats)
            station.wait_for_arm()
            figures += idle.measure()
            url = f"http://127.0.0.1:{settings.web.port}"
            crowds = (
                ("idle", _nobody),
                ("one core busy", _busy),
                ("learner and page busy", partial(learner_and_page, url)),
            )
            for load_, crowd in crowds:
                with crowd():
                    runs = [_execute(station, plan, seconds) for _ in range(repeats)]
                figures += _lateness(runs, load_, settings.executor.rate)
                error = [1e3 * run.tracking_error for run in runs]
                limit = 1e3 * settings.executor.largest_error
                what = f"tracking error of the simulated arm, {load_}"
                figures.append(against(what, error, "mrad", name="executor.largest_error", value=limit))
                given_up = float(sum(run.state == "faulted" for run in runs))
                figures.append(Figure(f"executions given up of {repeats}, {load_}", (given_up,), "executions"))
            figures += teleoperation.measure(station, endpoint, seconds=min(seconds, 20.0))
            figures += teleoperation.planning_slices(samples=500)
            executor = station.wait_for_arm().executor
            print(f"the executor says: {executor and executor.scheduling}\n", flush=True)
            return figures


def show(endpoint: str) -> None:
    """Let the synthetic hand show the paper's first experiment as the task demo, at once."""
    command = [sys.executable, "-m", "teachpath_client", "synthetic", "--scene", "paper", "--speed", "100"]
    subprocess.run([*command, "--endpoint", endpoint], check=True, stdout=subprocess.DEVNULL)


def _jobs(station: Station, repeats: int) -> tuple[list[Figure], str]:
    """Learn and plan as jobs of the service; returns the figures and a plan."""
    learned, _ = timed_job(station, lambda: station.begin_job("demo", "learn"))
    path = station.get_run("demo", learned.outcome).learned.paths[0].id
    planning = []
    for _ in range(repeats):
        planned, seconds = timed_job(station, lambda: station.begin_planning(path))
        planning.append(seconds)
    adapting = _adaptations(station, path, repeats)
    # A learning job that has nothing to learn from ends at once: what is left is the way there and back.
    station.make_task("nothing", scene="empty")
    begin = partial(station.begin_job, "nothing", "learn")
    empty = [timed_job(station, begin, state="failed")[1] for _ in range(5 * repeats)]
    round_trip = median(empty)
    return [
        Figure("job round trip over REST, nothing to do", tuple(empty), "s"),
        against("planning job, POST to outcome", planning, "s", name="round trip alone", value=round_trip),
        against("a path adapted, POST to certificate", adapting, "s", name="asked for", value=LONGEST_ADAPTATION),
    ], planned.outcome


def _adaptations(station: Station, path: str, repeats: int) -> list[float]:
    """Adapt a path to a goal a little farther on, again and again; returns how long each took [s]."""
    x, y, z = station.get_path(path).curve.control_points[-1]
    taken = []
    for count in range(1, repeats + 1):
        goal = {"position": [x + 0.005 * count, y, z]}
        taken.append(timed_job(station, partial(_adaptation, station, path, goal))[1])
    return taken


def _adaptation(station: Station, path: str, goal: dict[str, object]) -> Job:
    return station.adapt(path, goal=goal).job


def timed_job(
    station: Station, begin: Callable[[], Job], *, state: str = "succeeded", poll: float = POLL
) -> tuple[Job, float]:
    """Begin a job and wait for its end; return it and how long it took [s]."""
    began = time.perf_counter()
    job = begin()
    while job.state in ("queued", "running"):  # asked more often than `Station.wait` does: its time is the figure
        time.sleep(poll)
        job = station.get_job(job.id)
    if job.state != state:
        raise SystemExit(f"bench: the {job.kind} job {job.state}: {job.message}")
    return job, time.perf_counter() - began


def _execute(station: Station, plan: str, seconds: float) -> ExecutorStatus:
    """Run one execution to its end, or stop it after `seconds`; returns its last status."""
    execution = station.begin_execution(plan)
    try:
        return station.wait(execution, timeout=seconds).status
    except NotInTime:
        return station.wait(station.stop(execution.id)).status


def _lateness(runs: list[ExecutorStatus], crowd: str, rate: float) -> list[Figure]:
    period = 1e6 / rate
    names = {"p50": "lateness_p50_us", "p99": "lateness_p99_us", "max": "lateness_max_us"}
    cycles = sum(run.cycles for run in runs)
    figures = [
        against(
            f"executor lateness {name}, {crowd}",
            [getattr(run, field) for run in runs],
            "us",
            name="control period",
            value=period,
        )
        for name, field in names.items()
    ]
    missed = [100.0 * run.missed / run.cycles for run in runs]
    return [*figures, Figure(f"setpoints missed of {cycles:,}, {crowd}", tuple(missed), "%")]


@contextmanager
def _nobody() -> Iterator[None]:
    yield


@contextmanager
def _busy() -> Iterator[None]:
    """Keep one core busy."""
    process = subprocess.Popen([sys.executable, "-c", "while True: pass"])
    try:
        yield
    finally:
        process.kill()
        process.wait()
