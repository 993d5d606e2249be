"""adapt and object: paths for an object that lies elsewhere, and where that is."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from teachpath.commands.options import Json, Url, connected
from teachpath.commands.printing import print_answer
from teachpath.commands.progress import job_shown, progress_bar
from teachpath.commands.references import find_path, id_or_words
from teachpath.errors import UnusableInput

if TYPE_CHECKING:
    from teachpath_client.models import Plan
    from teachpath_client.station import Station


def adapt(
    path: Annotated[str, typer.Argument(help="TASK/CLUSTER, or an id or its beginning.")],
    start: Annotated[
        str, typer.Option(help="Where the object lies: x,y,z [m], or x,y,z,qw,qx,qy,qz; as the station knows it.")
    ] = "",
    goal: Annotated[str, typer.Option(help="Where it is to go, likewise; where the version ends.")] = "",
    version: Annotated[int | None, typer.Option(help="To adapt; the newest on its main branch.")] = None,
    branch: Annotated[str, typer.Option(help="To continue or to begin; that of the version.")] = "",
    url: Url = "",
    json_: Json = False,
) -> None:
    """Adapt a learned path to an object that lies elsewhere, and certify it.

    Saves a new version with the shape of all demonstrations of the same way, between the new start and goal.
    """
    from teachpath.commands.tables import plan_lines

    with connected(url) as station:
        plan = adapted_plan(station, find_path(station, path), start, goal, version=version, branch=branch)
    print_answer(plan, plan_lines(plan), json_=json_)


def adapted_plan(station: Station, path: str, start: str, goal: str, **options: Any) -> Plan:
    """Adapt a path, print how sure that is, and return the plan; empty ends are left to the station."""
    ends = {"start": pose(start, "--start") if start else None, "goal": pose(goal, "--goal") if goal else None}
    adapted = station.adapt(path, **ends, **options)
    print(
        f"version {adapted.version.number} of {path}, on branch {adapted.version.branch}: {adapted.note}",
        file=sys.stderr,
    )
    with progress_bar("planning") as show:
        return station.get_plan(station.outcome(adapted.job, job_shown(show)))


def object_(
    scene: Annotated[str, typer.Argument(help="The scene, by name or as people call it.", callback=id_or_words)],
    at: Annotated[str, typer.Option(help="Where its object lies: x,y,z [m], or x,y,z,qw,qx,qy,qz.")] = "",
    reset: Annotated[bool, typer.Option("--reset", help="It lies where the scene has it.")] = False,
    url: Url = "",
    json_: Json = False,
) -> None:
    """Say where the object of a scene lies, or ask it.

    Plans that take it elsewhere do not start; `teachpath run PATH --adapt` takes it where it lies.
    """
    if at and reset:
        raise UnusableInput("--at says where the object lies, --reset puts it back; give one of them")
    with connected(url) as station:
        if at:
            lies = station.tell_object(scene, **pose(at, "--at"))
        else:
            lies = station.reset_object(scene) if reset else station.get_object(scene)
    print_answer(
        lies,
        f"the object of scene {scene} lies at {', '.join(f'{value:.3f}' for value in lies.position)} m",
        json_=json_,
    )


def pose(text: str, option: str) -> dict[str, Any]:
    """Read x,y,z or x,y,z,qw,qx,qy,qz."""
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (3, 7):
        raise UnusableInput(f"{option} {text!r} is not x,y,z or x,y,z,qw,qx,qy,qz; write for instance 0.4,-0.3,0.5")
    return {"position": numbers[:3], "orientation": numbers[3:]} if len(numbers) == 7 else {"position": numbers}
