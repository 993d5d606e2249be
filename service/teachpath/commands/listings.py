"""What a station keeps, as a table: how each kind is listed, found by words, and shown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any, Final

from teachpath.commands.options import connected
from teachpath.commands.printing import moment, print_columns, print_json, print_list, verdict_word
from teachpath.commands.references import find_execution, find_job, find_path, find_plan, find_run, id_or_words
from teachpath.commands.scenes import print_bodies
from teachpath.errors import NotFound
from teachpath.lengths import describe_length

if TYPE_CHECKING:
    from teachpath_client.models import (
        Execution,
        Job,
        LearnedPath,
        PathSummary,
        Plan,
        PlanSummary,
        Run,
        RunSummary,
        Scene,
        Task,
    )
    from teachpath_client.station import Station


@dataclass(frozen=True, slots=True)
class Listing:
    """One kind of what a station keeps.

    Attributes:
        columns: their names.
        row: of one that is listed, an entry a column.
        listed: returns those of a task (empty: of all), at most so many, newest first.
        found: returns the one that words mean; raises NotFound, or UnusableInput where several are meant.
        show: prints that one; None: as a row of its own.
        none: what is said where none is listed.
    """

    columns: tuple[str, ...]
    row: Callable[[Any], Sequence[object]]
    listed: Callable[[Station, str, int], Sequence[Any]]
    found: Callable[[Station, str], Any]
    show: Callable[[Station, Any], None] | None = None
    none: str = ""


def list_or_show(kind: Listing, words: str, url: str, *, task: str = "", limit: int = 0, json_: bool = False) -> None:
    """Print what a station has of one kind, or the one that `words` mean, as columns or as the JSON of REST."""
    with connected(url) as station:
        if not words:
            listed = kind.listed(station, task, limit)
            print_list(listed, kind.columns, map(kind.row, listed), none=kind.none, json_=json_)
            return
        found = kind.found(station, words)
        if json_:
            print_json(found)
        elif kind.show:
            kind.show(station, found)
        else:
            print_columns(kind.columns, [kind.row(found)], none=kind.none)


def _task_row(task: Task) -> Sequence[object]:
    return task.name, task.display_name, task.scene, task.calibration, moment(task.created_ns)


def _found_task(station: Station, words: str) -> Task:
    known = station.tasks() + station.tasks(archived=True)
    name = next((each.name for each in known if each.display_name == words), id_or_words(words))
    if name not in (each.name for each in known):
        raise NotFound(f"there is no task {words!r}; list them with: teachpath tasks")
    return station.get_task(name)


def _show_task(station: Station, task: Task) -> None:
    name, gone = task.name, f", deleted {moment(task.archived_ns)}" if task.archived_ns else ""
    called = f", called {task.display_name}" if task.display_name else ""
    print(f"task {name}{called}: scene {task.scene}, calibration {task.calibration}, {moment(task.created_ns)}{gone}")
    verdicts = Counter(verdict_word(d.verdict) for d in station.demonstrations(name))
    print(f"demonstrations: {', '.join(f'{n} {verdict}' for verdict, n in verdicts.items()) or 'none'}")
    for run in station.runs(name, limit=1):
        paths = ", ".join(f"{name}/{path.rpartition('-')[2]}" for path in run.paths)
        print(f"newest run {run.id}, {moment(run.created_ns)}: paths {paths}")


def _run_row(run: RunSummary) -> Sequence[object]:
    return run.id, run.task, run.mode, run.demonstrations, len(run.paths), moment(run.created_ns)


def _found_run(station: Station, words: str) -> Run:
    found = find_run(station, words)
    return station.get_run(found.task, found.id)


def _show_run(station: Station, run: Run) -> None:
    from teachpath.commands.tables import print_run

    print_run(run, {d.id: d.number for d in station.demonstrations(run.task)})


def _path_row(path: PathSummary) -> Sequence[object]:
    return path.id, path.task, path.cluster, path.versions, moment(path.created_ns)


def _show_path(station: Station, path: LearnedPath) -> None:
    curve, fit = path.curve, path.fit
    print(f"path {path.id}, cluster {path.cluster} of run {path.run}, newest version {path.version}")
    print(f"degree {curve.degree}, {len(curve.control_points)} control points")
    if fit:
        print(f"largest error {1e3 * fit.largest:.2g} mm, tube radius {1e3 * fit.tube:.2g} mm")


def _plan_row(plan: PlanSummary) -> Sequence[object]:
    path, revoked = f"{plan.path} v{plan.path_version}", "revoked" if plan.revoked else ""
    clearance = describe_length(plan.clearance)
    return plan.id, plan.task, path, f"{plan.duration:.2f} s", clearance, revoked, plan.author, moment(plan.created_ns)


def _show_plan(station: Station, plan: Plan) -> None:
    from teachpath.commands.tables import plan_lines

    print(plan_lines(plan))


def _job_row(job: Job) -> Sequence[object]:
    return job.id, job.task, job.kind, job.state, job.outcome or job.message, moment(job.created_ns)


def _execution_row(execution: Execution) -> Sequence[object]:
    status = execution.status
    by = execution.plan or "a live hand"
    return execution.id, by, status.state, f"{status.progress:.0%}", status.reason, moment(execution.created_ns)


def _scene_row(scene: Scene) -> Sequence[object]:
    obstacles = ", ".join(obstacle.name for obstacle in scene.obstacles)
    return scene.name, scene.display_name, obstacles or "none", scene.carried.name if scene.carried else ""


def _found_scene(station: Station, words: str) -> Scene:
    found = [scene for scene in station.scenes() if words == scene.display_name or scene.name == id_or_words(words)]
    if not found:
        raise NotFound(f"there is no scene {words!r}; list them with: teachpath scenes")
    return found[0]


TASKS: Final = Listing(
    columns=("task", "called", "scene", "calibration", "made"),
    row=_task_row,
    listed=lambda station, task, limit: station.tasks(),
    found=_found_task,
    show=_show_task,
    none="no tasks yet; teachpath demo shows one",
)
ARCHIVED_TASKS: Final = replace(
    TASKS, listed=lambda station, task, limit: station.tasks(archived=True), none="no task is deleted"
)
RUNS: Final = Listing(
    columns=("run", "task", "mode", "demonstrations", "paths", "learned"),
    row=_run_row,
    listed=lambda station, task, limit: station.runs(task, limit=limit),
    found=_found_run,
    show=_show_run,
    none="no runs yet: teachpath learn TASK",
)
PATHS: Final = Listing(
    columns=("path", "task", "cluster", "versions", "learned"),
    row=_path_row,
    listed=lambda station, task, limit: station.paths(task, limit=limit),
    found=lambda station, words: station.get_path(find_path(station, words)),
    show=_show_path,
    none="no paths yet: teachpath learn TASK",
)
PLANS: Final = Listing(
    columns=("plan", "task", "path", "duration", "clearance", "", "by", "made"),
    row=_plan_row,
    listed=lambda station, task, limit: station.plan_summaries(task, limit=limit),
    found=lambda station, words: station.get_plan(find_plan(station, words)),
    show=_show_plan,
    none="no plans yet: teachpath plan PATH",
)
JOBS: Final = Listing(
    columns=("job", "task", "kind", "state", "outcome", "begun"),
    row=_job_row,
    listed=lambda station, task, limit: station.jobs(task, limit=limit),
    found=lambda station, words: station.get_job(find_job(station, words)),
    none="no jobs yet",
)
EXECUTIONS: Final = Listing(
    columns=("execution", "plan", "state", "progress", "reason", "begun"),
    row=_execution_row,
    listed=lambda station, task, limit: station.executions(limit=limit),
    found=lambda station, words: station.get_execution(find_execution(station, words)),
    none="no executions yet: teachpath run PLAN",
)
SCENES: Final = Listing(
    columns=("scene", "called", "obstacles", "object"),
    row=_scene_row,
    listed=lambda station, task, limit: station.scenes(),
    found=_found_scene,
    show=lambda station, scene: print_bodies(asdict(scene)),
)
