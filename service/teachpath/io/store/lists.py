"""The lists of a station's rows: one method a list, each a page at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, TypeVar

from sqlalchemy import Engine, Select, func, select
from sqlalchemy.orm import Bundle, Session, aliased, defer

from teachpath.errors import NotFound
from teachpath.io.documents import from_document
from teachpath.io.store.pages import Listing, Page, PageRequest
from teachpath.io.store.rows import demonstration_of, job_of, task_of
from teachpath.io.store.tables import (
    DemonstrationRow,
    ExecutionTable,
    JobRow,
    JournalRow,
    PathRow,
    PlanRow,
    RevocationRow,
    RunTable,
    TaskRow,
)
from teachpath.io.store.versions import version_of
from teachpath.records import (
    Demonstration,
    ExecutorStatus,
    Job,
    JournalEntry,
    PathSummary,
    Plan,
    PlanSummary,
    RunSummary,
    Task,
    Version,
)
from teachpath_proto.control import JournalVerb

T = TypeVar("T")

FIRST_PAGE: Final = PageRequest()
TASKS: Final = Listing("tasks", (TaskRow.created_ns, TaskRow.name))
DEMONSTRATIONS: Final = Listing("demonstrations", (DemonstrationRow.number,))
RUNS: Final = Listing("runs", (RunTable.created_ns, RunTable.id), newest_first=True)
JOBS: Final = Listing("jobs", (JobRow.created_ns, JobRow.id), newest_first=True)
PATHS: Final = Listing("paths", (PathRow.created_ns, PathRow.id), newest_first=True)
PLANS: Final = Listing("plans", (PlanRow.created_ns, PlanRow.id), newest_first=True)
VERSIONS: Final = Listing("versions", (PathRow.version,))
EXECUTIONS: Final = Listing("executions", (ExecutionTable.created_ns, ExecutionTable.id), newest_first=True)
JOURNAL: Final = Listing("journal", (JournalRow.number,), newest_first=True)


@dataclass(frozen=True, slots=True)
class Execution:
    """An execution as stored; `plan` is None when the arm followed a live hand.

    Attributes:
        id: of the execution.
        plan: id of the plan; None: the arm followed a live hand.
        created_ns: when it was ordered [ns since the Unix epoch].
        status: the newest of the executor.
        station: whose arm moved; empty where it has no name.
    """

    id: str
    plan: str | None
    created_ns: int
    status: ExecutorStatus
    station: str = ""


class Lists:
    """The lists of a station; every method raises UnusableInput for a cursor that is none of its list."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def tasks(self, wanted: PageRequest = FIRST_PAGE, *, archived: bool = False) -> Page[Task]:
        """List the tasks that are there, or those that are archived, oldest first."""
        question = select(TaskRow).where(TaskRow.archived_ns != 0 if archived else TaskRow.archived_ns == 0)
        return self._read(TASKS, question, wanted, task_of)

    def demonstrations(self, task: str, wanted: PageRequest = FIRST_PAGE) -> Page[Demonstration]:
        """List the demonstrations of a task in their order."""
        question = select(DemonstrationRow).where(DemonstrationRow.task == task)
        return self._read(DEMONSTRATIONS, question, wanted, demonstration_of)

    def runs(self, task: str | None, wanted: PageRequest = FIRST_PAGE) -> Page[RunSummary]:
        """List the learning runs of a task, or of all that are not archived, newest first, without what was learned."""
        question = select(RunTable).options(defer(RunTable.document))
        return self._read(RUNS, _of_open_task(question, task), wanted, _summary)

    def jobs(self, task: str | None, wanted: PageRequest = FIRST_PAGE) -> Page[Job]:
        """List the jobs of a task, or all, newest first."""
        question = select(JobRow) if task is None else select(JobRow).where(JobRow.task == task)
        return self._read(JOBS, question, wanted, job_of)

    def path_summaries(self, task: str | None = None, wanted: PageRequest = FIRST_PAGE) -> Page[PathSummary]:
        """List the learned paths of a task, or of all that are not archived, newest first."""
        versions = aliased(PathRow)
        count = select(func.count()).where(versions.id == PathRow.id).scalar_subquery().label("versions")
        cluster = PathRow.document["cluster"].as_integer().label("cluster")
        columns = (PathRow.id, RunTable.task, PathRow.run, cluster, count, PathRow.created_ns)
        question: Select[Any] = select(Bundle("path", *columns)).join(RunTable, RunTable.id == PathRow.run)
        question = _of_open_task(question.where(PathRow.parent.is_(None)), task)
        return self._read(PATHS, question, wanted, lambda row: PathSummary(**row._asdict()))

    def plan_summaries(self, task: str | None = None, wanted: PageRequest = FIRST_PAGE) -> Page[PlanSummary]:
        """List the plans of a task, or of all that are not archived, newest first, without what they hold."""
        document = PlanRow.document
        columns = (
            PlanRow.id,
            RunTable.task,
            PlanRow.path,
            document["path_version"].as_integer().label("path_version"),
            document["scene"]["name"].as_string().label("scene"),
            document["duration"].as_float().label("duration"),
            document["certificate"]["clearance"]["value"].as_float().label("clearance"),
            RevocationRow.plan.is_not(None).label("revoked"),
            PlanRow.created_ns,
            func.coalesce(document["author"].as_string(), "").label("author"),
        )
        question: Select[Any] = (
            select(Bundle("plan", *columns))
            .join(PathRow, (PathRow.id == PlanRow.path) & PathRow.parent.is_(None))
            .join(RunTable, RunTable.id == PathRow.run)
            .outerjoin(RevocationRow, RevocationRow.plan == PlanRow.id)
        )
        return self._read(PLANS, _of_open_task(question, task), wanted, lambda row: PlanSummary(**row._asdict()))

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
    return Execution(row.id, row.plan, row.created_ns, from_document(ExecutorStatus, row.document), row.station)


def _of_open_task(question: Select[Any], task: str | None) -> Select[Any]:
    """Ask for what came of the runs of a task, or of all tasks that are not archived."""
    if task is not None:
        return question.where(RunTable.task == task)
    return question.join(TaskRow, TaskRow.name == RunTable.task).where(TaskRow.archived_ns == 0)


def _summary(row: RunTable) -> RunSummary:
    return from_document(RunSummary, row.summary)


def _entry(row: JournalRow) -> JournalEntry:
    return JournalEntry(row.at_ns, row.who, JournalVerb(row.verb), row.execution, row.answer)
