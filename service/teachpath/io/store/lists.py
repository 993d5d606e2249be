"""The lists of a station's rows: one method a list, each a page at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, TypeVar

from sqlalchemy import Engine, Select, func, select
from sqlalchemy.orm import Session, defer

from teachpath.errors import NotFound
from teachpath.io.documents import from_document
from teachpath.io.store.pages import Listing, Page, PageRequest
from teachpath.io.store.rows import job_of, task_of
from teachpath.io.store.tables import (
    DemonstrationRow,
    ExecutionTable,
    JobRow,
    JournalRow,
    PathRow,
    PlanRow,
    RunTable,
    TaskRow,
)
from teachpath.io.store.versions import version_of
from teachpath.records import (
    Demonstration,
    ExecutorStatus,
    Job,
    JournalEntry,
    Plan,
    RunSummary,
    Task,
    Version,
)

T = TypeVar("T")

FIRST_PAGE: Final = PageRequest()
TASKS: Final = Listing("tasks", (TaskRow.created_ns, TaskRow.name))
DEMONSTRATIONS: Final = Listing("demonstrations", (DemonstrationRow.number,))
RUNS: Final = Listing("runs", (RunTable.created_ns, RunTable.id), newest_first=True)
JOBS: Final = Listing("jobs", (JobRow.created_ns, JobRow.id), newest_first=True)
PLANS: Final = Listing("plans", (PlanRow.created_ns, PlanRow.id), newest_first=True)
VERSIONS: Final = Listing("versions", (PathRow.version,))
EXECUTIONS: Final = Listing("executions", (ExecutionTable.created_ns, ExecutionTable.id), newest_first=True)
JOURNAL: Final = Listing("journal", (JournalRow.number,), newest_first=True)


@dataclass(frozen=True, slots=True)
class Execution:
    """An execution as stored; `plan` is None when the arm followed a live hand."""

    id: str
    plan: str | None
    created_ns: int
    status: ExecutorStatus


class Lists:
    """The lists of a station; every method raises UnusableInput for a cursor that is none of its list."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def tasks(self, wanted: PageRequest = FIRST_PAGE) -> Page[Task]:
        """List tasks, oldest first."""
        return self._read(TASKS, select(TaskRow), wanted, task_of)

    def demonstrations(self, task: str, wanted: PageRequest = FIRST_PAGE) -> Page[Demonstration]:
        """List the demonstrations of a task in their order."""
        question = select(DemonstrationRow).where(DemonstrationRow.task == task)
        return self._read(DEMONSTRATIONS, question, wanted, lambda row: from_document(Demonstration, row.document))

    def runs(self, task: str, wanted: PageRequest = FIRST_PAGE) -> Page[RunSummary]:
        """List the learning runs of a task, newest first, without what was learned."""
        question = select(RunTable).where(RunTable.task == task).options(defer(RunTable.document))
        return self._read(RUNS, question, wanted, _summary)

    def jobs(self, task: str, wanted: PageRequest = FIRST_PAGE) -> Page[Job]:
        """List the jobs of a task, newest first."""
        return self._read(JOBS, select(JobRow).where(JobRow.task == task), wanted, job_of)

    def job_counts(self) -> dict[tuple[str, ...], float]:
        """Return how many jobs there are of each kind and state."""
        question = select(JobRow.kind, JobRow.state, func.count()).group_by(JobRow.kind, JobRow.state)
        with Session(self._engine) as session:
            return {(kind, state): count for kind, state, count in session.execute(question)}

    def plans(self, path: str, wanted: PageRequest = FIRST_PAGE) -> Page[Plan]:
        """List the plans of a path, newest first."""
        question = select(PlanRow).where(PlanRow.path == path)
        return self._read(PLANS, question, wanted, lambda row: from_document(Plan, row.document))

    def versions(self, path: str, wanted: PageRequest = FIRST_PAGE) -> Page[Version]:
        """List the versions of a path over all its branches, oldest first; raises NotFound."""
        question = select(PathRow).where(PathRow.id == path).options(defer(PathRow.document))
        found = self._read(VERSIONS, question, wanted, version_of)
        if not found.entries and not wanted.after:
            raise NotFound(f"there is no path {path!r}")
        return found

    def executions(self, wanted: PageRequest = FIRST_PAGE) -> Page[Execution]:
        """List executions, newest first."""
        return self._read(EXECUTIONS, select(ExecutionTable), wanted, execution_of)

    def journal(self, execution: str = "", wanted: PageRequest = FIRST_PAGE) -> Page[JournalEntry]:
        """List who did what to the arm, newest first: all, or of one execution."""
        question = select(JournalRow)
        if execution:
            question = question.where(JournalRow.execution == execution)
        return self._read(JOURNAL, question, wanted, _entry)

    def _read(
        self, listing: Listing, question: Select[Any], wanted: PageRequest, record_of: Callable[[Any], T]
    ) -> Page[T]:
        with Session(self._engine) as session:
            return listing.read(session, question, wanted, record_of)


def execution_of(row: ExecutionTable) -> Execution:
    """Return the execution of a row."""
    return Execution(row.id, row.plan, row.created_ns, from_document(ExecutorStatus, row.document))


def _summary(row: RunTable) -> RunSummary:
    return from_document(RunSummary, row.summary)


def _entry(row: JournalRow) -> JournalEntry:
    return JournalEntry(row.at_ns, row.who, row.verb, row.execution, row.answer)
