"""status, tasks, runs, paths, plans, jobs, executions, arms and scenes of a running station."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer

from teachpath.commands.options import Json, Url, connected
from teachpath.commands.printing import moment, print_columns, print_json, print_list, verdict_word
from teachpath.commands.references import find_execution, find_job, find_path, find_plan, find_run
from teachpath.commands.scenes import print_bodies
from teachpath.errors import NotFound
from teachpath.lengths import describe_length

if TYPE_CHECKING:
    from teachpath_client.models import Execution, Health, PlanSummary, Robot
    from teachpath_client.station import Station

Limit = Annotated[int, typer.Option(min=1, help="Of those listed, newest first.")]
OfTask = Annotated[str, typer.Option("--task", help="Only those of one task.")]


def status(url: Url = "", json_: Json = False) -> None:
    """Say how the station is: its parts, the arm, trackers, and what needs somebody."""
    with connected(url) as station:
        health = station.health()
        if json_:
            print_json(health)
            return
        print(f"teachpath {health.version} at {station.url}, up {health.uptime:.0f} s")
    for line in _status_lines(health):
        print(line)


def _status_lines(health: Health) -> list[str]:
    executor = health.executor
    arm = f"{executor.state}{f': {executor.reason}' if executor.reason else ''}" if executor else "no executor has said"
    trackers = ", ".join(f"{t.name}{' (recorded)' if t.name in health.recording else ''}" for t in health.trackers)
    lines = [
        f"arm {health.bus.robot}: {arm}",
        "parts: " + (", ".join(f"{name} {state}" for name, state in health.processes.items()) or "none of their own"),
        f"trackers: {trackers or 'none'}",
    ]
    if health.guidance.sentence:
        lines.append(f"task {health.guidance.task}: {health.guidance.sentence}")
    return lines + [f"note: {note}" for note in health.notes]


def tasks(
    task: Annotated[str, typer.Argument(help="One of them; all unless given.")] = "",
    archived: Annotated[bool, typer.Option("--archived", help="List those that were deleted: all are kept.")] = False,
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the tasks, or show one: its demonstrations by verdict, and the paths of its newest run."""
    with connected(url) as station:
        if not task:
            listed = station.tasks(archived=archived)
            rows = [(t.name, t.scene, t.calibration, moment(t.created_ns)) for t in listed]
            none = "no task is deleted" if archived else "no tasks yet; teachpath demo shows one"
            names = ("task", "scene", "calibration", "made")
            print_list(listed, names, rows, none=none, json_=json_)
            return
        known = station.tasks() + station.tasks(archived=True)
        if task not in (each.name for each in known):
            raise NotFound(f"there is no task {task!r}; list them with: teachpath tasks")
        shown = station.get_task(task)
        if json_:
            print_json(shown)
            return
        gone = f", deleted {moment(shown.archived_ns)}" if shown.archived_ns else ""
        print(f"task {task}: scene {shown.scene}, calibration {shown.calibration}, {moment(shown.created_ns)}{gone}")
        verdicts = Counter(verdict_word(d.verdict) for d in station.demonstrations(task))
        print(f"demonstrations: {', '.join(f'{n} {verdict}' for verdict, n in verdicts.items()) or 'none'}")
        for run in station.runs(task, limit=1):
            paths = ", ".join(f"{task}/{path.rpartition('-')[2]}" for path in run.paths)
            print(f"newest run {run.id}, {moment(run.created_ns)}: paths {paths}")


def runs(
    run: Annotated[str, typer.Argument(help="An id or its beginning, a task, or last; all unless given.")] = "",
    task: OfTask = "",
    limit: Limit = 20,
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the learning runs, or show one: clusters, who was left out and why, and paths."""
    with connected(url) as station:
        if run:
            _show_run(station, run, json_)
            return
        listed = station.runs(task, limit=limit)
        rows = [(r.id, r.task, r.mode, r.demonstrations, len(r.paths), moment(r.created_ns)) for r in listed]
        names = ("run", "task", "mode", "demonstrations", "paths", "learned")
        print_list(listed, names, rows, none="no runs yet: teachpath learn TASK", json_=json_)


def _show_run(station: Station, words: str, json_: bool) -> None:
    found = find_run(station, words)
    run = station.get_run(found.task, found.id)
    if json_:
        print_json(run)
        return
    from teachpath.commands.tables import print_run

    print_run(run, {d.id: d.number for d in station.demonstrations(run.task)})


def paths(
    path: Annotated[str, typer.Argument(help="TASK/CLUSTER, an id or its beginning; all unless given.")] = "",
    task: OfTask = "",
    limit: Limit = 20,
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the learned paths, or show one."""
    with connected(url) as station:
        if path:
            shown = station.get_path(find_path(station, path))
            if json_:
                print_json(shown)
                return
            curve, fit = shown.curve, shown.fit
            print(f"path {shown.id}, cluster {shown.cluster} of run {shown.run}, newest version {shown.version}")
            print(f"degree {curve.degree}, {len(curve.control_points)} control points")
            if fit:
                print(f"largest error {1e3 * fit.largest:.2g} mm, tube radius {1e3 * fit.tube:.2g} mm")
            return
        listed = station.paths(task, limit=limit)
        rows = [(p.id, p.task, p.cluster, p.versions, moment(p.created_ns)) for p in listed]
        names = ("path", "task", "cluster", "versions", "learned")
        print_list(listed, names, rows, none="no paths yet: teachpath learn TASK", json_=json_)


def plans(
    plan: Annotated[str, typer.Argument(help="An id or its beginning, TASK/CLUSTER, or last; all unless given.")] = "",
    task: OfTask = "",
    limit: Limit = 20,
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the plans, or show one with its certificate."""
    with connected(url) as station:
        if plan:
            from teachpath.commands.tables import plan_lines

            shown = station.get_plan(find_plan(station, plan))
            if json_:
                print_json(shown)
            else:
                print(plan_lines(shown))
            return
        listed = station.plan_summaries(task, limit=limit)
        rows = [(*_figures(p), "revoked" if p.revoked else "", moment(p.created_ns)) for p in listed]
        names = ("plan", "task", "path", "duration", "clearance", "", "made")
        print_list(listed, names, rows, none="no plans yet: teachpath plan PATH", json_=json_)


def _figures(plan: PlanSummary) -> tuple[str, ...]:
    path = f"{plan.path} v{plan.path_version}"
    return plan.id, plan.task, path, f"{plan.duration:.2f} s", describe_length(plan.clearance)


def jobs(
    job: Annotated[str, typer.Argument(help="An id or its beginning, or last; all unless given.")] = "",
    task: OfTask = "",
    limit: Limit = 20,
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the jobs, or show one."""
    with connected(url) as station:
        listed = [station.get_job(find_job(station, job))] if job else station.jobs(task, limit=limit)
    if json_:
        print_json(listed[0] if job else listed)
        return
    rows = [(j.id, j.task, j.kind, j.state, j.outcome or j.message, moment(j.created_ns)) for j in listed]
    print_columns(("job", "task", "kind", "state", "outcome", "begun"), rows, none="no jobs yet")


def executions(
    execution: Annotated[str, typer.Argument(help="An id or its beginning, or last; all unless given.")] = "",
    limit: Limit = 20,
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the executions, or show one."""
    with connected(url) as station:
        if execution:
            listed = [station.get_execution(find_execution(station, execution))]
        else:
            listed = station.executions(limit=limit)
    if json_:
        print_json(listed[0] if execution else listed)
        return
    names = ("execution", "plan", "state", "progress", "reason", "begun")
    print_columns(names, map(_execution_row, listed), none="no executions yet: teachpath run PLAN")


def _execution_row(execution: Execution) -> tuple[object, ...]:
    status = execution.status
    by = execution.plan or "a live hand"
    return execution.id, by, status.state, f"{status.progress:.0%}", status.reason, moment(execution.created_ns)


def arms(
    arm: Annotated[str, typer.Argument(help="One of them; all unless given.")] = "",
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the published arms that motion.variant may name, or show one; * marks that of the station.

    Those that motion.arm may name (teachpath arm add) are listed below; with --json only when one is named.
    """
    with connected(url) as station:
        listed, own = station.arms(), station.robot()
        stored = [each for each in station.stored_arms() if arm in ("", each.name)]
        chosen = [each for each in listed if arm in ("", each.variant)]
        if json_ and stored and not chosen:
            print_json(station.stored_arm(arm))
            return
    if not chosen and not stored:
        raise NotFound(f"there is no arm {arm!r}; list them with: teachpath arms")
    if json_:
        print_json(chosen[0] if arm else chosen)
        return
    rows = [
        ("*" if (robot.variant, "") == (own.variant, own.model) else "", robot.variant, *_lengths(robot))
        for robot in chosen
    ]
    if rows:
        print_columns(("", "arm", "a [mm]", "d [mm]"), rows, none="")
    if stored:
        versions = [
            ("*" if each.hash == own.model else "", f"{each.name}@{each.version}", ", ".join(each.joints), each.file)
            for each in stored
        ]
        print_columns(("", "arm", "joints", "model"), versions, none="")


def _lengths(robot: Robot) -> tuple[str, str]:
    links = robot.links
    return " ".join(f"{1e3 * link.a:.1f}" for link in links), " ".join(f"{1e3 * link.d:.1f}" for link in links)


def scenes(
    scene: Annotated[str, typer.Argument(help="One of them; all unless given.")] = "",
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the scenes, or show one: what stands around the arm, and where the object lies."""
    with connected(url) as station:
        listed = station.scenes()
    chosen = [each for each in listed if scene in ("", each.name)]
    if not chosen:
        raise NotFound(f"there is no scene {scene!r}; list them with: teachpath scenes")
    if json_:
        print_json(chosen[0] if scene else chosen)
    elif scene:
        print_bodies(asdict(chosen[0]))
    else:
        listed_rows = [
            (s.name, ", ".join(o.name for o in s.obstacles) or "none", s.carried.name if s.carried else "")
            for s in chosen
        ]
        print_columns(("scene", "obstacles", "object"), listed_rows, none="")
