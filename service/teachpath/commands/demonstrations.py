"""demonstrations and amend: list, mark, trim and discard what was shown."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from teachpath.commands.options import Json, Url, connected
from teachpath.commands.printing import print_answer, print_json, verdict_word
from teachpath.commands.work import Task
from teachpath.errors import NotFound, UnusableInput

if TYPE_CHECKING:
    from teachpath_client.models import Demonstration


class Mark(StrEnum):
    """The operator's opinion of a demonstration."""

    GOOD = "good"
    BAD = "bad"
    NONE = "none"


MARKS: dict[Mark, Literal["", "good", "bad"]] = {Mark.GOOD: "good", Mark.BAD: "bad", Mark.NONE: ""}  # as stored


def demonstrations(task: Task, url: Url = "", json_: Json = False) -> None:
    """List the demonstrations of a task with their verdicts and marks."""
    with connected(url) as station:
        shown = station.demonstrations(task)
    if json_:
        print_json(shown)
    else:
        _print(shown)


def _print(shown: list[Demonstration]) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table()
    for column in ("No.", "Verdict", "Transport [s]", "Lost", "Said", "Why"):
        table.add_column(column, justify="right" if column in ("No.", "Transport [s]", "Lost") else "left")
    for d in shown:
        lost, why = str(d.statistics.lost), "; ".join(d.reasons)
        table.add_row(str(d.number), verdict_word(d.verdict), f"{d.duration:.2f}", lost, _said(d), why)
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
    url: Url = "",
    json_: Json = False,
) -> None:
    """Mark, trim or discard a demonstration. Nothing of it is ever deleted."""
    if mark is None and discard is None and not trim:
        raise UnusableInput("say what is to be changed: --mark, --trim, --discard or --restore")
    with connected(url) as station:
        found = [d for d in station.demonstrations(task) if d.number == number]
        if not found:
            raise NotFound(
                f"task {task} has no demonstration {number}; list them with: teachpath demonstrations {task}"
            )
        trimmed = _trimmed(found[0], trim) if trim else None
        d = station.amend(found[0].id, mark=MARKS[mark] if mark else None, discarded=discard, trim=trimmed)
    print_answer(
        d,
        f"{task} {number}: {'; '.join([verdict_word(d.verdict), _said(d) or 'nothing said', *d.reasons])}",
        json_=json_,
    )


def _trimmed(d: Demonstration, trim: str) -> tuple[int, int]:
    """Return the transport phase without its ends, as indices into the samples."""
    try:
        begin, end = (float(part) for part in trim.split(","))
    except ValueError:
        raise UnusableInput(f"--trim {trim} is not BEGIN,END in seconds, e.g. 0.2,0.5") from None
    rate = d.statistics.seen_rate
    own = (d.release - d.grasp) / rate
    if begin < 0.0 or end < 0.0 or begin + end >= own:
        raise UnusableInput(f"--trim {trim}: together they must be under the {own:.2f} s from grasp to release")
    if begin == end == 0.0:
        return 0, 0
    return d.grasp + round(begin * rate), d.release - round(end * rate)


def _said(d: Demonstration) -> str:
    trimmed = "trimmed" if d.trim else ""
    discarded = "discarded" if d.discarded_ns else ""
    return ", ".join(filter(None, (d.mark, trimmed, discarded)))
