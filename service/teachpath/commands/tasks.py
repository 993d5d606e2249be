"""task: delete, restore and rename a task, with all that is of it."""

from __future__ import annotations

from typing import Annotated

import typer

from teachpath.commands.options import Json, Url, connected
from teachpath.commands.printing import print_answer
from teachpath.commands.references import id_or_words
from teachpath.commands.work import Task

app: typer.Typer = typer.Typer(
    no_args_is_help=True, help="Delete a task, bring it back, or rename it; `tasks` lists them."
)


@app.command()
def delete(task: Task, url: Url = "", json_: Json = False) -> None:
    """Archive a task: lists leave it out, and nothing is begun with it any more. All of it is kept."""
    with connected(url) as station:
        deleted = station.delete_task(task)
    print_answer(
        deleted, f"task {task} is deleted, and kept; bring it back with: teachpath task restore {task}", json_=json_
    )


@app.command()
def restore(task: Task, url: Url = "", json_: Json = False) -> None:
    """Bring back a task that was deleted, with its demonstrations, runs, paths and plans."""
    with connected(url) as station:
        restored = station.restore_task(task)
    print_answer(restored, f"task {task} is back", json_=json_)


@app.command()
def rename(
    task: Task,
    name: Annotated[str, typer.Argument(help="Another name, with spaces and any letters; no task may have it.")],
    url: Url = "",
    json_: Json = False,
) -> None:
    """Give a task another name; demonstrations, runs, paths, plans and jobs go with it.

    A name with spaces or umlauts is what people read; commands and addresses have the one that is made of it
    ("Küche räumen": kueche-raeumen).
    """
    other = id_or_words(name)
    with connected(url) as station:
        renamed = station.rename_task(task, other, display_name=name if other != name else "")
    called = f"{renamed.display_name} ({renamed.name})" if renamed.display_name else renamed.name
    print_answer(renamed, f"task {task} is called {called} now", json_=json_)
