"""Rows of the tables, and the records that they are."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from teachpath.io.documents import from_document, to_document
from teachpath.io.store.display_names import require_distinct
from teachpath.io.store.engine import lock_name
from teachpath.io.store.imported_files import with_note
from teachpath.io.store.tables import DemonstrationRow, JobRow, RunTable, TaskRow
from teachpath.records import Demonstration, Failure, Job, JobState, Learned, RunSummary, Task


@dataclass(frozen=True, eq=False)
class Run:
    """A learning run as stored.

    Attributes:
        id: of the run.
        task: name of the task.
        created_ns: when it was made [ns since the Unix epoch].
        learned: its result.
    """

    id: str
    task: str
    created_ns: int
    learned: Learned

    @property
    def summary(self) -> RunSummary:
        """What a list says of it."""
        learned, paths = self.learned, tuple(path.id for path in self.learned.paths)
        return RunSummary(self.id, self.task, self.created_ns, learned.mode, len(learned.demonstrations), paths)


def success(outcome: str, now: int) -> dict[str, Any]:
    """Return what changes in the row of a job that has succeeded."""
    return {"state": JobState.SUCCEEDED.value, "fraction": 1.0, "outcome": outcome, "finished_ns": now, "message": ""}


def ensured_task(session: Session, task: Task) -> TaskRow:
    """Return the row of a task; added when there is none, and Conflict where another one is called so."""
    lock_name(session, "task", task.name)
    row = session.get(TaskRow, task.name)
    if row is None:
        require_distinct(session, task.name, task.display_name)
        row = TaskRow(**{**asdict(task), "created_ns": time.time_ns()})
        session.add(row)
    return row


def numbered_row(session: Session, demonstration: Demonstration, station: str) -> Demonstration:
    """Add the row of a demonstration of a station under the next number of its task; return it with that number."""
    lock_name(session, "task", demonstration.task)
    newest = session.scalar(
        select(func.max(DemonstrationRow.number)).where(DemonstrationRow.task == demonstration.task)
    )
    numbered = replace(demonstration, number=(newest or 0) + 1, station=station)
    session.add(
        DemonstrationRow(
            id=numbered.id,
            task=numbered.task,
            number=numbered.number,
            created_ns=numbered.created_ns,
            verdict=numbered.verdict.value,
            document=demonstration_document(numbered),
            station=station,
        )
    )
    return numbered


def demonstration_of(row: DemonstrationRow) -> Demonstration:
    """Return the demonstration of a row; raises UnusableInput."""
    return replace(from_document(Demonstration, row.document), station=row.station)


def demonstration_document(demonstration: Demonstration) -> dict[str, Any]:
    """Return what the row of a demonstration says of it; a station that gets a name is in the row alone."""
    document: dict[str, Any] = to_document(replace(demonstration, station=""))
    return document


def imported_rows(
    session: Session, task: Task, made: Sequence[Demonstration], added: list[str], station: str
) -> list[Demonstration]:
    """Add the rows of a file's demonstrations that are not there yet, and return all as they are stored.

    The places of the recordings whose rows are new are added to `added`.
    """
    ensured_task(session, task)
    session.flush()
    stored: list[Demonstration] = []
    for demonstration in with_note(session, made):
        row = session.get(DemonstrationRow, demonstration.id)
        if row is None:
            added.append(demonstration.recording)
            stored.append(numbered_row(session, demonstration, station))
        else:
            stored.append(demonstration_of(row))
        session.flush()
    return stored


def task_of(row: TaskRow) -> Task:
    """Return the task of a row."""
    return Task(**{name: getattr(row, name) for name in Task.__dataclass_fields__})


def job_of(row: JobRow) -> Job:
    """Return the job of a row."""
    fields = {name: getattr(row, name) for name in Job.__dataclass_fields__}
    failure = None if row.failure is None else from_document(Failure, row.failure)
    return Job(**{**fields, "state": JobState(row.state), "failure": failure})


def run_of(row: RunTable) -> Run:
    """Return the learning run of a row."""
    return Run(row.id, row.task, row.created_ns, from_document(Learned, row.document))
