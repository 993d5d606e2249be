"""What is done with a task as a whole: archive it, bring it back, call it otherwise. Nothing of it is ever removed."""

from __future__ import annotations

import time
from typing import Final

from sqlalchemy import Engine, func, select, update
from sqlalchemy.orm import Session

from teachpath.errors import Conflict, NotFound
from teachpath.io.store.changes import Changed, changing, note
from teachpath.io.store.display_names import require_distinct
from teachpath.io.store.engine import lock_name
from teachpath.io.store.job_claims import UNFINISHED_STATES
from teachpath.io.store.rows import task_of
from teachpath.io.store.tables import DemonstrationRow, JobRow, PathRow, PlanRow, RunTable, TaskRow
from teachpath.records import Task

COPIED_COLUMNS: Final = tuple(column.name for column in TaskRow.__table__.columns if column.name != "name")


class TaskChanges:
    """Archives, brings back and renames tasks; who records one is asked by whoever calls this."""

    def __init__(self, engine: Engine, changed: Changed) -> None:
        self._engine, self._changed = engine, changed

    def archive(self, name: str) -> Task:
        """Archive a task, so that lists leave it out and nothing is begun with it; one that is archived stays as it is.

        Raises:
            NotFound: no such task.
            Conflict: a job of it waits or runs.
        """
        with changing(self._engine, self._changed) as session:
            row = _locked(session, name)
            _require_no_jobs(session, name)
            row.archived_ns = row.archived_ns or time.time_ns()
        return task_of(row)

    def restore(self, name: str) -> Task:
        """Bring back a task that was archived; one that was not stays as it is. Raises NotFound."""
        with changing(self._engine, self._changed) as session:
            row = _locked(session, name)
            row.archived_ns = 0
        return task_of(row)

    def rename(self, name: str, to: str, display_name: str | None = None) -> Task:
        """Give a task another name, with all that is of it; its recordings go on saying what they were recorded as.

        Args:
            name: of the task.
            to: its name from now on, which may be the same.
            display_name: what people call it from now on; None: as before.

        Raises:
            NotFound: no such task.
            Conflict: there is a task of the other name, or called so, or a job of this one waits or runs.
        """
        with changing(self._engine, self._changed) as session:
            for each in sorted({name, to}):  # in one order, so that nobody waits for each other
                lock_name(session, "task", each)
            row = _locked(session, name)
            if display_name is not None:
                require_distinct(session, name, display_name)
                row.display_name = display_name
            if name == to:
                return task_of(row)
            if (taken := session.get(TaskRow, to)) is not None:
                raise Conflict(_taken(taken))
            _require_no_jobs(session, name)
            renamed = TaskRow(name=to, **{column: getattr(row, column) for column in COPIED_COLUMNS})
            session.add(renamed)
            session.flush()
            _move_rows(session, name, to)
            session.delete(row)
        return task_of(renamed)

    def require_open_plan(self, plan: str) -> None:
        """Raise Conflict where a plan is of a task that is archived."""
        question = (
            select(TaskRow)
            .join(RunTable, RunTable.task == TaskRow.name)
            .join(PathRow, (PathRow.run == RunTable.id) & PathRow.parent.is_(None))
            .join(PlanRow, PlanRow.path == PathRow.id)
        )
        with Session(self._engine) as session:
            row = session.scalar(question.where(PlanRow.id == plan))
        if row is not None:
            require_open(task_of(row))


def require_open(task: Task) -> Task:
    """Return a task with which something is to begin; raises Conflict where it is archived."""
    if task.archived_ns:
        raise Conflict(
            f"task {task.name} was deleted, and is kept; bring it back first (teachpath task restore {task.name}), or "
            "take another name"
        )
    return task


def _locked(session: Session, name: str) -> TaskRow:
    lock_name(session, "task", name)
    row = session.get(TaskRow, name, with_for_update=True) if "\0" not in name else None
    if row is None:
        raise NotFound(f"there is no task {name!r}")
    return row


def _require_no_jobs(session: Session, name: str) -> None:
    of_task = select(func.count()).select_from(JobRow).where(JobRow.task == name, JobRow.state.in_(UNFINISHED_STATES))
    if count := session.scalar(of_task):
        raise Conflict(f"{count} jobs of task {name} wait or run; wait until they have ended, or cancel them")


def _move_rows(session: Session, name: str, to: str) -> None:
    """Let everything that names a task name it by another name."""
    demonstrations = select(DemonstrationRow).where(DemonstrationRow.task == name)
    for demonstration in session.scalars(demonstrations.with_for_update()):
        demonstration.task, demonstration.document = to, {**demonstration.document, "task": to}
    for run in session.scalars(select(RunTable).where(RunTable.task == name)):
        run.task, run.summary = to, {**run.summary, "task": to}
    jobs = list(session.scalars(select(JobRow.id).where(JobRow.task == name)))
    session.execute(update(JobRow).where(JobRow.task == name).values(task=to))
    for job in jobs:
        note(session, JobRow.__tablename__, job)
    session.flush()  # before the row goes that they named


def _taken(task: TaskRow) -> str:
    deleted = f", which was deleted; bring it back with: teachpath task restore {task.name}" if task.archived_ns else ""
    return f"there is a task {task.name} already{deleted}"
