"""learn, recut, recalibrate, plan and replay: work of a running service."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from teachpath.commands.options import Json, Url, connected
from teachpath.commands.printing import print_answer, print_json, verdict_word
from teachpath.commands.progress import job_shown, progress_bar
from teachpath.commands.references import find_path, find_run, id_or_words
from teachpath.errors import NotFound

if TYPE_CHECKING:
    from teachpath_client.models import BusSettings, Dendrogram, Job
    from teachpath_client.station import Station

Task = Annotated[str, typer.Argument(help="The task, by name or as people call it.", callback=id_or_words)]
AsRecorded = Annotated[bool, typer.Option(help="Also those under a former version of their calibration.")]
CALIBRATIONS = {False: "present", True: "recorded"}  # by --as-recorded


def learn(
    task: Task,
    url: Url = "",
    mode: Annotated[str, typer.Option(help="default: to be trusted; paper: Aleotti & Caselli 2005.")] = "default",
    threshold: Annotated[float | None, typer.Option(help="Height of the cut [m]; mode paper needs it.")] = None,
    as_recorded: AsRecorded = False,
    json_: Json = False,
) -> None:
    """Find the ways and learn a path for each.

    Clusters the task's demonstrations, selects the consistent ones in each cluster, and fits a NURBS to them.
    """
    settings: dict[str, object] = {"mode": mode} | ({} if threshold is None else {"threshold": threshold})
    with connected(url) as station:
        job = station.begin_job(task, "learn", settings=settings, calibrations=CALIBRATIONS[as_recorded])
        _print_learned(station, job, "learning", json_=json_)


def recut(
    task: Task,
    clusters: Annotated[int | None, typer.Option(min=1, help="Number of ways to cut into.")] = None,
    threshold: Annotated[float | None, typer.Option(help="Or the height of the cut [m].")] = None,
    run: Annotated[str, typer.Option(help="An id of a run or its beginning; empty: the task's newest.")] = "",
    as_recorded: AsRecorded = False,
    url: Url = "",
    json_: Json = False,
) -> None:
    """Move the cut between the ways, and learn their paths anew.

    Distances are not measured again; the outcome is a new run. Without --clusters and --threshold it lists the cuts
    to choose from.
    """
    with connected(url) as station:
        chosen = find_run(station, run).id if run else next((r.id for r in station.runs(task, limit=1)), "")
        if not chosen:
            raise NotFound(f"task {task} has no run whose cut could be moved; first: teachpath learn {task}")
        if clusters is None and threshold is None:
            _print_cuts(station.dendrogram(task, chosen), json_=json_)
            return
        calibrations = CALIBRATIONS[as_recorded]
        job = station.begin_job(
            task, "recut", run=chosen, clusters=clusters, threshold=threshold, calibrations=calibrations
        )
        _print_learned(station, job, "cutting", json_=json_)


def _print_cuts(dendrogram: Dendrogram, *, json_: bool) -> None:
    if json_:
        print_json(dendrogram)
        return
    from rich.console import Console

    from teachpath.commands.tables import cuts_table

    Console().print(cuts_table(dendrogram))


def _print_learned(station: Station, job: Job, title: str, *, json_: bool) -> None:
    """Wait for a job that learns, and print what it learned."""
    from teachpath.commands.tables import print_run

    with progress_bar(title) as show:
        run = station.get_run(job.task, station.outcome(job, job_shown(show)))
    if json_:
        print_json(run)
    else:
        print_run(run, {d.id: d.number for d in station.demonstrations(job.task)})


def recalibrate(
    task: Task,
    calibration: Annotated[str, typer.Option(help="Name, or name@version; else each one's own, today's.")] = "",
    url: Url = "",
    json_: Json = False,
) -> None:
    """Put demonstrations under another calibration.

    For a task that was recorded before a tracker's frame was measured better: its samples are mapped to the world
    anew and judged again. Nothing is lost; --calibration NAME@1 puts them back under the first version.
    """
    with connected(url) as station:
        changed = station.recalibrate(task, calibration)
    if json_:
        print_json(changed)
    else:
        for d in changed:
            print(f"{task} {d.number}: {d.calibration.name}, {'; '.join([verdict_word(d.verdict), *d.reasons])}")


def plan(
    path: Annotated[str, typer.Argument(help="TASK/CLUSTER, or an id or its beginning.")],
    version: Annotated[int | None, typer.Option(help="Its version; the newest on its main branch.")] = None,
    posture: Annotated[
        Literal["shown", "free"], typer.Option(help="Prefer the joints that an arm showed, where one did; or not.")
    ] = "shown",
    output: Annotated[str, typer.Option(help="Output of the arm that is on along the path; none unless given.")] = "",
    output_start: Annotated[float, typer.Option(help="[s] to rest at the start with it on.")] = 0.0,
    output_end: Annotated[float, typer.Option(help="[s] to rest at the end with it on.")] = 0.0,
    url: Url = "",
    json_: Json = False,
) -> None:
    """Certify a learned path, or say why not."""
    from teachpath.commands.tables import plan_lines
    from teachpath_client.models import ToolOutput

    wanted = ToolOutput(name=output, start=output_start, end=output_end) if output else None
    with connected(url) as station:
        found = find_path(station, path)
        with progress_bar("planning") as show:
            made = station.plan(found, version, posture=posture, output=wanted, on_change=job_shown(show))
    print_answer(made, plan_lines(made), json_=json_)


def replay(
    task: Task,
    into: Annotated[
        str, typer.Option(help="Task that they are recorded into; made when missing.", callback=id_or_words)
    ] = "",
    number: Annotated[list[int] | None, typer.Option(help="Only these demonstrations; may be repeated.")] = None,
    speed: Annotated[float, typer.Option(help="1 = original timing.")] = 1.0,
    url: Url = "",
) -> None:
    """Publish stored demonstrations as if live.

    Every sample goes over Zenoh at its original pace, as if a tracker showed it now, and is recorded anew.
    """
    with connected(url) as station:
        stored, demonstrations, bus = station.get_task(task), station.demonstrations(task), station.health().bus
    chosen = [d.id for d in demonstrations if not number or d.number in number]
    if not chosen:
        raise NotFound(
            f"task {task} has no such demonstrations, but {len(demonstrations)} others; list them with: "
            f"teachpath demonstrations {task}"
        )
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
