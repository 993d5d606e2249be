"""status, tasks, runs, paths, plans, jobs, executions, arms and scenes of a running station."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from teachpath.commands.listings import (
    ARCHIVED_TASKS,
    EXECUTIONS,
    JOBS,
    PATHS,
    PLANS,
    RUNS,
    SCENES,
    TASKS,
    list_or_show,
)
from teachpath.commands.options import Json, Url, connected
from teachpath.commands.printing import print_columns, print_json
from teachpath.commands.references import id_or_words
from teachpath.errors import NotFound

if TYPE_CHECKING:
    from teachpath_client.models import Health, Robot

Limit = Annotated[int, typer.Option(min=1, help="Of those listed, newest first.")]
OfTask = Annotated[str, typer.Option("--task", help="Only those of one task.", callback=id_or_words)]


def status(url: Url = "", json_: Json = False) -> None:
    """Say how the station is: its parts, the arm, trackers, and what needs somebody."""
    with connected(url) as station:
        health = station.health()
        if json_:
            print_json(health)
            return
        called = f"{health.display_name}: " if health.display_name else ""
        print(f"{called}teachpath {health.version} at {station.url}, up {health.uptime:.0f} s")
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
    list_or_show(ARCHIVED_TASKS if archived else TASKS, task, url, json_=json_)


def runs(
    run: Annotated[str, typer.Argument(help="An id or its beginning, a task, or last; all unless given.")] = "",
    task: OfTask = "",
    limit: Limit = 20,
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the learning runs, or show one: clusters, who was left out and why, and paths."""
    list_or_show(RUNS, run, url, task=task, limit=limit, json_=json_)


def paths(
    path: Annotated[str, typer.Argument(help="TASK/CLUSTER, an id or its beginning; all unless given.")] = "",
    task: OfTask = "",
    limit: Limit = 20,
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the learned paths, or show one."""
    list_or_show(PATHS, path, url, task=task, limit=limit, json_=json_)


def plans(
    plan: Annotated[str, typer.Argument(help="An id or its beginning, TASK/CLUSTER, or last; all unless given.")] = "",
    task: OfTask = "",
    limit: Limit = 20,
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the plans, or show one with its certificate."""
    list_or_show(PLANS, plan, url, task=task, limit=limit, json_=json_)


def jobs(
    job: Annotated[str, typer.Argument(help="An id or its beginning, or last; all unless given.")] = "",
    task: OfTask = "",
    limit: Limit = 20,
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the jobs, or show one."""
    list_or_show(JOBS, job, url, task=task, limit=limit, json_=json_)


def executions(
    execution: Annotated[str, typer.Argument(help="An id or its beginning, or last; all unless given.")] = "",
    limit: Limit = 20,
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the executions, or show one."""
    list_or_show(EXECUTIONS, execution, url, limit=limit, json_=json_)


def scenes(
    scene: Annotated[str, typer.Argument(help="One of them; all unless given.")] = "",
    url: Url = "",
    json_: Json = False,
) -> None:
    """List the scenes, or show one: what stands around the arm, and where the object lies."""
    list_or_show(SCENES, scene, url, json_=json_)


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
