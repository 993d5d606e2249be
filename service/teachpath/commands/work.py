"""learn, plan, run and replay: commands for a running service."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from teachpath.commands.options import LOCAL, Config, Url
from teachpath.commands.tables import clusters_table, cuts_table, paths_table, plan_lines, reasons
from teachpath.errors import UnusableInput
from teachpath_client.models import BusSettings, Execution, Job
from teachpath_client.station import Station
from teachpath_proto.control import ExecutorState

Task = Annotated[str, typer.Argument(help="The task.")]
AsRecorded = Annotated[bool, typer.Option(help="Also those under a former version of their calibration.")]
CALIBRATIONS = {False: "present", True: "recorded"}  # by --as-recorded
console = Console(stderr=True)


Show = Callable[[float, str], None]


@contextmanager
def progress_bar(title: str) -> Iterator[Show]:
    """Show a bar on the error stream where that is a terminal; yields `show(fraction, sentence)`."""
    columns = (
        TextColumn("{task.description:<10}"),
        BarColumn(),
        TextColumn("{task.fields[what]}"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, disable=not console.is_terminal) as bar:
        row = bar.add_task(title, total=1.0, what="")
        yield lambda fraction, what: bar.update(row, completed=fraction, what=what)


def job_shown(show: Show) -> Callable[[Job], None]:
    """Return what shows how a job goes on."""
    return lambda job: show(job.fraction, job.message or job.state)


def execution_shown(show: Show) -> Callable[[Execution], None]:
    """Return what shows how an execution goes on."""
    return lambda execution: show(execution.status.progress, execution_state(execution))


def execution_state(execution: Execution) -> str:
    """Return what the arm does in an execution, and why."""
    return ": ".join(filter(None, (execution.status.state, execution.status.reason)))


def learn(
    task: Task,
    url: Url = LOCAL,
    mode: Annotated[str, typer.Option(help="default: to be trusted; paper: Aleotti & Caselli 2005.")] = "default",
    threshold: Annotated[float | None, typer.Option(help="Height of the cut [m]; mode paper needs it.")] = None,
    as_recorded: AsRecorded = False,
) -> None:
    """Find the ways and learn a path for each.

    Clusters the task's demonstrations, selects the consistent ones in each cluster, and fits a NURBS to them.
    """
    settings: dict[str, object] = {"mode": mode} | ({} if threshold is None else {"threshold": threshold})
    with Station(url) as station:
        job = station.begin_job(task, "learn", settings=settings, calibrations=CALIBRATIONS[as_recorded])
        _print_learned(station, job, "learning")


def recut(
    task: Task,
    clusters: Annotated[int | None, typer.Option(min=1, help="Number of ways to cut into.")] = None,
    threshold: Annotated[float | None, typer.Option(help="Or the height of the cut [m].")] = None,
    run: Annotated[str, typer.Option(help="Id of the run; empty: the task's newest.")] = "",
    as_recorded: AsRecorded = False,
    url: Url = LOCAL,
) -> None:
    """Move the cut between the ways, and learn their paths anew.

    Distances are not measured again; the outcome is a new run. Without --clusters and --threshold it lists the cuts
    to choose from.
    """
    with Station(url) as station:
        chosen = run or next((newest.id for newest in station.runs(task, limit=1)), "")
        if not chosen:
            sys.exit(f"teachpath: task {task} has no run whose cut could be moved; first: teachpath learn {task}")
        if clusters is None and threshold is None:
            Console().print(cuts_table(station.dendrogram(task, chosen)))
            return
        calibrations = CALIBRATIONS[as_recorded]
        job = station.begin_job(
            task, "recut", run=chosen, clusters=clusters, threshold=threshold, calibrations=calibrations
        )
        _print_learned(station, job, "cutting")


def _print_learned(station: Station, job: Job, title: str) -> None:
    """Wait for a job that learns, and print what it learned."""
    with progress_bar(title) as show:
        run = station.get_run(job.task, station.outcome(job, job_shown(show)))
    numbers = {d.id: d.number for d in station.demonstrations(job.task)}
    out = Console()
    out.print(clusters_table(run, numbers))
    out.print(paths_table(run))
    for line in reasons(run, numbers):
        out.print(line, highlight=False)


def recalibrate(
    task: Task,
    calibration: Annotated[str, typer.Option(help="Name, or name@version; else each one's own, today's.")] = "",
    url: Url = LOCAL,
) -> None:
    """Put demonstrations under another calibration.

    For a task that was recorded before a tracker's frame was measured better: its samples are mapped to the world
    anew and judged again. Nothing is lost; --calibration NAME@1 puts them back under the first version.
    """
    with Station(url) as station:
        for d in station.recalibrate(task, calibration):
            print(f"{task} {d.number}: {d.calibration.name}, {'; '.join([d.verdict, *d.reasons])}")


def plan(
    path: Annotated[str, typer.Argument(help="Id of a learned path.")],
    version: Annotated[int | None, typer.Option(help="Its version; the newest on its main branch.")] = None,
    url: Url = LOCAL,
) -> None:
    """Certify a learned path, or say why not."""
    with Station(url) as station, progress_bar("planning") as show:
        print(plan_lines(station.plan(path, version, on_change=job_shown(show))))


def run(
    plan: Annotated[
        str | None,
        typer.Argument(help="Id of a plan; with --check, the one that was meant; with --adapt, of a path."),
    ] = None,
    url: Url = LOCAL,
    config: Config = None,
    override: Annotated[float, typer.Option(min=0.0, max=1.0, help="Share of the planned speed.")] = 1.0,
    check: Annotated[
        Path | None,
        typer.Option(
            help="Move nothing; judge this log of setpoints against limits and path: MCAP, or CSV t,q1,...,q6."
        ),
    ] = None,
    detach: Annotated[
        bool, typer.Option(help="Only start it: the arm goes on without this command, and anybody may command it.")
    ] = False,
    adapt: Annotated[
        bool, typer.Option(help="First adapt a path to where the station knows its object to lie, and certify it.")
    ] = False,
    goal: Annotated[str, typer.Option(help="With --adapt: where it is to go, x,y,z [m]; where the path ends.")] = "",
) -> None:
    """Move the arm along a certified plan, or judge what was sent to one.

    This command is in control meanwhile. Ctrl-C stops the arm on its path; when the command is killed or hangs, the arm
    is held there within 4 s. None of this is an emergency stop.
    """
    from teachpath.commands.adaptation import adapted_plan
    from teachpath.commands.checking import judge_file

    if check is not None:
        judge_file(check, plan, url, config)
        return
    if plan is None:
        raise UnusableInput("name the plan to run; teachpath plan PATH makes one")
    if goal and not adapt:
        raise UnusableInput("--goal is for --adapt; a plan has its goal")
    with Station(url, operator="teachpath run") as station:
        if adapt:
            plan = adapted_plan(station, plan, "", goal).id
        if detach:
            execution = station.begin_execution(plan, override=override)
            print(f"{execution.id} {execution.status.state}; teachpath stop {execution.id} stops it")
            return
        execution = _run_to_its_end(station, plan, override)
    status = execution.status
    print(
        f"{execution.id} {status.state}: {status.cycles} setpoints, {status.late} late, "
        f"{status.missed} missed; limits used to {status.limit_use:.1%}, "
        f"tracking error up to {1e3 * status.tracking_error:.2f} mrad"
    )


def _run_to_its_end(station: Station, plan: str, override: float) -> Execution:
    with station.control(), progress_bar("running") as show:
        execution = station.begin_execution(plan, override=override)
        try:
            return station.finish(execution, execution_shown(show))
        except KeyboardInterrupt:
            return station.finish(station.stop(execution.id), execution_shown(show))


def stop(
    execution: Annotated[str, typer.Argument(help="Id of an execution; empty: whatever moves.")] = "",
    url: Url = LOCAL,
) -> None:
    """Stop the arm on its path, whoever moves it.

    It says "stopped" when the executor's own status shows it; else it says NOT STOPPED and ends with exit status 1,
    while the service goes on trying. This is not an emergency stop.
    """
    with Station(url) as station:
        status = station.stop(execution).status if execution else station.stop_arm()
    if not ExecutorState(status.state).is_resting:
        print(f"stopped: {status.execution} comes to rest on its path")
    else:
        print(
            f"stopped: {status.execution} has {status.state}" if status.execution else "stopped: nothing moves the arm"
        )


def acknowledge(url: Url = LOCAL) -> None:
    """Let the arm be moved again that moved unasked, once you have seen why.

    Nothing starts before; it is refused while the arm does not rest for 2 s.
    """
    with Station(url, operator="teachpath acknowledge") as station:
        station.acknowledge_motion()
    print("acknowledged: executions may start")


def replay(
    task: Annotated[str, typer.Argument(help="Task whose demonstrations are played.")],
    into: Annotated[str, typer.Option(help="Task that they are recorded into; made when missing.")] = "",
    number: Annotated[list[int] | None, typer.Option(help="Only these demonstrations; may be repeated.")] = None,
    speed: Annotated[float, typer.Option(help="1 = original timing.")] = 1.0,
    url: Url = LOCAL,
) -> None:
    """Publish stored demonstrations as if live.

    Every sample goes over Zenoh at its original pace, as if a tracker showed it now, and is recorded anew.
    """
    with Station(url) as station:
        stored, demonstrations, bus = station.get_task(task), station.demonstrations(task), station.health().bus
    chosen = [d.id for d in demonstrations if not number or d.number in number]
    if not chosen:
        sys.exit(f"teachpath: task {task} has no such demonstrations; it has {len(demonstrations)}")
    command = replay_command(
        chosen,
        url=url,
        bus=bus,
        task=into or f"{task}-replayed",
        scene=stored.scene,
        calibration=stored.calibration,
        speed=speed,
    )
    sys.exit(subprocess.run(command, check=False).returncode)


def replay_command(
    demonstrations: list[str], *, url: str, bus: BusSettings, task: str, scene: str, calibration: str, speed: float
) -> list[str]:
    """Return the command of the client process that replays `demonstrations` into `task`."""
    options = {
        "--url": url,
        "--endpoint": bus.endpoint,
        "--prefix": bus.prefix,
        "--task": task,
        "--scene": scene,
        "--calibration": calibration,
        "--tracker": "replay",
        "--speed": str(speed),
    }
    words = [word for option in options.items() for word in option]
    return [sys.executable, "-m", "teachpath_client", "replay", *demonstrations, *words]
