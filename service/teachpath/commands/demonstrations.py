"""What an operator says of demonstrations: which are good or bad, where they begin and end, which do not count."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from teachpath.commands.options import LOCAL, Url
from teachpath.commands.rest import Api
from teachpath.commands.work import Task
from teachpath.errors import NotFound, UnusableInput


class Mark(StrEnum):
    """What an operator thinks of a demonstration."""

    GOOD = "good"
    BAD = "bad"
    NONE = "none"


def demonstrations(task: Task, url: Url = LOCAL) -> None:
    """List the demonstrations of a task, with what is thought and said of them."""
    with Api(url) as api:
        table = Table()
        for column in ("No.", "Verdict", "Transport [s]", "Lost", "Said", "Why"):
            table.add_column(column, justify="right" if column in ("No.", "Transport [s]", "Lost") else "left")
        for d in api.call("GET", f"/tasks/{task}/demonstrations"):
            lost = str(d["account"]["lost"])
            row = [str(d["number"]), d["verdict"], f"{d['duration']:.2f}", lost, _said(d), "; ".join(d["reasons"])]
            table.add_row(*row)
        Console().print(table)


def amend(
    task: Task,
    number: Annotated[int, typer.Argument(help="Number of the demonstration.")],
    mark: Annotated[Mark | None, typer.Option(help="A bad one is kept and not learned from.")] = None,
    trim: Annotated[
        str,
        typer.Option(metavar="BEGIN,END", help="[s] to take off both ends of the recorder's own cut; 0,0 undoes it."),
    ] = "",
    discard: Annotated[bool | None, typer.Option("--discard/--restore", help="Or bring it back.")] = None,
    url: Url = LOCAL,
) -> None:
    """Mark, trim or discard a demonstration. Nothing of it is ever deleted."""
    with Api(url) as api:
        found = [d for d in api.call("GET", f"/tasks/{task}/demonstrations") if d["number"] == number]
        if not found:
            raise NotFound(
                f"task {task} has no demonstration {number}; list them with: teachpath demonstrations {task}"
            )
        changes: dict[str, Any] = {}
        if mark is not None:
            changes["mark"] = "" if mark is Mark.NONE else mark.value
        if discard is not None:
            changes["discarded"] = discard
        if trim:
            changes["trim"] = _trimmed(found[0], trim)
        if not changes:
            raise UnusableInput("say what is to be changed: --mark, --trim, --discard or --restore")
        d = api.call("PATCH", f"/demonstrations/{found[0]['id']}", changes)
        print(f"{task} {number}: {'; '.join([d['verdict'], _said(d) or 'nothing said', *d['reasons']])}")


def _trimmed(d: dict[str, Any], trim: str) -> list[int]:
    """Return the transport phase without its ends, as indices into the samples."""
    try:
        begin, end = (float(part) for part in trim.split(","))
    except ValueError:
        raise UnusableInput(f"--trim {trim} is not BEGIN,END in seconds, e.g. 0.2,0.5") from None
    rate = d["account"]["seen_rate"]
    own = (d["release"] - d["grasp"]) / rate
    if begin < 0.0 or end < 0.0 or begin + end >= own:
        raise UnusableInput(f"--trim {trim}: together they must be under the {own:.2f} s from grasp to release")
    if begin == end == 0.0:
        return [0, 0]
    return [d["grasp"] + round(begin * rate), d["release"] - round(end * rate)]


def _said(d: dict[str, Any]) -> str:
    trimmed = "trimmed" if d["trim"] else ""
    discarded = "discarded" if d["discarded_ns"] else ""
    return ", ".join(filter(None, (d["mark"], trimmed, discarded)))
