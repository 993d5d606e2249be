"""How far a job or an execution has come, as a bar on the error stream."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from teachpath_client.models import Execution, Job

Show = Callable[[float, str], None]


@contextmanager
def progress_bar(title: str) -> Iterator[Show]:
    """Show a bar on the error stream where that is a terminal; yields `show(fraction, sentence)`."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description:<10}"),
        BarColumn(),
        TextColumn("{task.fields[what]}"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, disable=not console.is_terminal) as bar:
        row = bar.add_task(title, total=1.0, what="begins")
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
