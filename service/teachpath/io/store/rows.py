"""Rows of tasks, demonstrations and jobs, and the records that they are."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from teachpath.io.documents import from_document, to_document
from teachpath.io.store.tables import DemonstrationRow, JobRow, TaskRow
from teachpath.records import Demonstration, Failure, Job, JobState, Task


def success(outcome: str, now: int) -> dict[str, Any]:
    """Return what changes in the row of a job that has succeeded."""
    return {"state": JobState.SUCCEEDED.value, "fraction": 1.0, "outcome": outcome, "finished_ns": now, "message": ""}


def ensured_task(session: Session, name: str, scene: str, calibration: str) -> TaskRow:
    """Return the row of a task; added when there is none."""
    row = session.get(TaskRow, name)
    if row is None:
        row = TaskRow(name=name, scene=scene, calibration=calibration, created_ns=time.time_ns())
        session.add(row)
    return row


def numbered_row(session: Session, demonstration: Demonstration) -> Demonstration:
    """Add the row of a demonstration under the next number of its task, and return it with that number."""
    newest = session.scalar(
        select(func.max(DemonstrationRow.number)).where(DemonstrationRow.task == demonstration.task)
    )
    numbered = replace(demonstration, number=(newest or 0) + 1)
    session.add(
        DemonstrationRow(
            id=numbered.id,
            task=numbered.task,
            number=numbered.number,
            created_ns=numbered.created_ns,
            verdict=numbered.verdict,
            document=to_document(numbered),
        )
    )
    return numbered


def task_of(row: TaskRow) -> Task:
    """Return the task of a row."""
    return Task(row.name, row.scene, row.calibration, row.created_ns)


def job_of(row: JobRow) -> Job:
    """Return the job of a row."""
    fields = {name: getattr(row, name) for name in Job.__dataclass_fields__}
    failure = None if row.failure is None else from_document(Failure, row.failure)
    return Job(**{**fields, "state": JobState(row.state), "failure": failure})
