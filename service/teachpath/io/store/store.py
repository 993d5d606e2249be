"""The database of a station: one method a question, every change one transaction."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from sqlalchemy import select
from sqlalchemy.orm import Session

from teachpath.errors import NotFound, StorageUnavailable
from teachpath.io.documents import from_document, to_document
from teachpath.io.store.access_tokens import AccessTokens
from teachpath.io.store.arms import Arms
from teachpath.io.store.calibrations import MeasuredCalibrations
from teachpath.io.store.change_feed import ChangeFeed
from teachpath.io.store.changes import Changed, changing, unheard
from teachpath.io.store.checks import Checks
from teachpath.io.store.database_files import database_file, database_url, make_data_folder, make_database_file
from teachpath.io.store.engine import lock_name, open_engine
from teachpath.io.store.imported_files import ImportedFiles
from teachpath.io.store.job_claims import UNFINISHED_STATES, JobClaims
from teachpath.io.store.journal import Journal
from teachpath.io.store.lists import Execution, Lists, execution_of
from teachpath.io.store.motions import Motions
from teachpath.io.store.people import People
from teachpath.io.store.recordings import RECORDINGS, Opener, Recordings, open_new
from teachpath.io.store.rows import (
    Run,
    demonstration_document,
    demonstration_of,
    ensured_task,
    imported_rows,
    job_of,
    numbered_row,
    run_of,
    success,
    task_of,
)
from teachpath.io.store.scenes import StoredScenes
from teachpath.io.store.services import Services
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.spool import Spool
from teachpath.io.store.storage_health import StorageHealth
from teachpath.io.store.tables import Base, DemonstrationRow, ExecutionTable, JobRow, PlanRow, RunTable, TaskRow
from teachpath.io.store.task_changes import TaskChanges, require_open
from teachpath.io.store.versions import Versions, learned_row
from teachpath.records import Demonstration, ExecutorStatus, Job, Learned, LearnedPath, Plan, Task
from teachpath_proto.control import ExecutorState

Row = TypeVar("Row", bound=Base)
Batch = Sequence[tuple[Sequence[Demonstration], Path]]  # demonstrations, each with the folder of their recordings


class Store:
    """The rows of a station, and its recordings; safe to use from several threads."""

    def __init__(self, settings: StoreSettings, *, opener: Opener = open_new, changed: Changed = unheard) -> None:
        """Open the database; `opener` opens the files of new recordings, `changed` hears of every changed row."""
        folder = make_data_folder(settings)
        make_database_file(settings)
        self.recordings: Recordings = Recordings(folder / RECORDINGS, opener, settings.recordings, settings.cache_size)
        self.motions: Motions = Motions(folder / "executions", opener)
        engine = open_engine(database_url(settings))
        self.services: Services = Services(engine, settings.station, folder)
        self._engine, self._changed = engine.execution_options(service=self.services.id), changed
        self.arms: Arms = Arms(self._engine)
        self.feed: ChangeFeed = ChangeFeed(engine, self.services.id, changed)
        self.claims: JobClaims = JobClaims(self._engine, self.services, changed)
        self.calibrations: MeasuredCalibrations = MeasuredCalibrations(self._engine)
        self.task_changes: TaskChanges = TaskChanges(self._engine, changed)
        self.imported_files: ImportedFiles = ImportedFiles(self._engine)
        self.scenes: StoredScenes = StoredScenes(self._engine, changed)
        self.versions: Versions = Versions(self._engine, changed)
        self.journal: Journal = Journal(self._engine)
        self.access_tokens: AccessTokens = AccessTokens(self._engine)
        self.people: People = People(self._engine)
        self.lists: Lists = Lists(self._engine)
        self.checks: Checks = Checks(self._engine, settings.station)
        self.spool: Spool = Spool(self.recordings, self.checks.places, self.demonstration, self.change_demonstration)
        self.health: StorageHealth = StorageHealth(folder / RECORDINGS, self._engine, database_file(settings))

    def close(self) -> None:
        """Close every connection."""
        self.spool.stop()
        self.feed.stop()
        with suppress(StorageUnavailable):  # then others find out by themselves
            self.services.end()
        self._engine.dispose()

    def _change(self) -> AbstractContextManager[Session]:
        return changing(self._engine, self._changed)

    def _all(self, question: Any) -> list[Any]:
        with Session(self._engine) as session:
            return list(session.scalars(question))

    def _one(self, table: type[Row], key: Any, what: str) -> Row:
        with Session(self._engine) as session:
            row = session.get(table, key) if "\0" not in str(key) else None  # which no database with a server keeps
        if row is None:
            raise NotFound(f"there is no {what} {key!r}")
        return row

    # tasks and demonstrations

    def ensure_task(
        self, name: str, *, scene: str, calibration: str, object_at_grasp: bool = False, display_name: str = ""
    ) -> Task:
        """Return the task `name`; made with the other arguments when it does not exist."""
        with self._change() as session:
            return task_of(ensured_task(session, Task(name, scene, calibration, 0, object_at_grasp, 0, display_name)))

    def tasks(self) -> list[Task]:
        """List the tasks that are not archived, oldest first."""
        rows = self._all(select(TaskRow).where(TaskRow.archived_ns == 0).order_by(TaskRow.created_ns))
        return [task_of(row) for row in rows]

    def task(self, name: str) -> Task:
        """Return one task, archived or not; raises NotFound."""
        return task_of(self._one(TaskRow, name, "task"))

    def open_task(self, name: str) -> Task:
        """Return a task with which something is to begin; raises NotFound, or Conflict where it is archived."""
        return require_open(self.task(name))

    def add_demonstration(self, demonstration: Demonstration) -> Demonstration:
        """Store a demonstration under the next number of its task and return it with that number."""
        with self._change() as session:
            return numbered_row(session, demonstration, self.services.station)

    def demonstrations(self, task: str) -> list[Demonstration]:
        """List the demonstrations of a task in their order."""
        question = select(DemonstrationRow).where(DemonstrationRow.task == task).order_by(DemonstrationRow.number)
        return [demonstration_of(row) for row in self._all(question)]

    def demonstration(self, key: str) -> Demonstration:
        """Return one demonstration; raises NotFound."""
        return demonstration_of(self._one(DemonstrationRow, key, "demonstration"))

    def change_demonstration(self, key: str, **changes: Any) -> Demonstration:
        """Change fields of a demonstration and return it; raises NotFound."""
        with self._change() as session:
            row = session.get(DemonstrationRow, key, with_for_update=True)
            if row is None:
                raise NotFound(f"there is no demonstration {key!r}")
            changed = replace(demonstration_of(row), **changes)
            row.document, row.verdict = demonstration_document(changed), changed.verdict.value
        return changed

    # runs, paths and plans

    def newest_run(self, task: str) -> Run | None:
        """Return the newest learning run of a task; None: nothing was learned of it yet."""
        question = select(RunTable).where(RunTable.task == task).order_by(RunTable.created_ns.desc()).limit(1)
        return next((run_of(row) for row in self._all(question)), None)

    def run(self, key: str) -> Run:
        """Return one learning run; raises NotFound."""
        return run_of(self._one(RunTable, key, "run"))

    def path(self, key: str) -> LearnedPath:
        """Return the newest version of a learned path on its main branch; raises NotFound."""
        return self.versions.newest(key)

    def plans(self, path: str) -> list[Plan]:
        """List the plans of a path, newest first."""
        question = select(PlanRow).where(PlanRow.path == path).order_by(PlanRow.created_ns.desc())
        return [from_document(Plan, row.document) for row in self._all(question)]

    def plan(self, key: str) -> Plan:
        """Return one plan; raises NotFound."""
        return from_document(Plan, self._one(PlanRow, key, "plan").document)

    # executions

    def put_execution(self, key: str, plan: str | None, status: ExecutorStatus) -> None:
        """Store how an execution stands."""
        with self._change() as session:
            lock_name(session, "execution", key)
            row = session.get(ExecutionTable, key)
            if row is None:
                row = ExecutionTable(id=key, plan=plan, created_ns=time.time_ns(), station=self.services.station)
                session.add(row)
            row.document = to_document(status)

    def execution(self, key: str) -> Execution:
        """Return one execution; raises NotFound."""
        return execution_of(self._one(ExecutionTable, key, "execution"))

    def unfinished_executions(self) -> list[Execution]:
        """List the executions of this station whose last stored status is not their end."""
        resting = [state.value for state in ExecutorState if state.is_resting]
        state = ExecutionTable.document["state"].as_string()
        question = select(ExecutionTable).where(state.not_in(resting), ExecutionTable.station == self.services.station)
        return [execution_of(row) for row in self._all(question)]

    # jobs

    def add_job(self, job: Job) -> None:
        """Store a new job."""
        with self._change() as session:
            session.add(JobRow(**{**to_document(job), "state": job.state.value, "station": self.services.station}))

    def job(self, key: str) -> Job:
        """Return one job; raises NotFound."""
        return job_of(self._one(JobRow, key, "job"))

    def jobs(self, *, task: str | None = None, unfinished: bool = False) -> list[Job]:
        """List jobs, oldest first: all, those of a task, or those of this station that are not finished."""
        question = select(JobRow).order_by(JobRow.created_ns)
        if task is not None:
            question = question.where(JobRow.task == task)
        if unfinished:
            question = question.where(JobRow.state.in_(UNFINISHED_STATES), JobRow.station == self.services.station)
        return [job_of(row) for row in self._all(question)]

    def awaited_uploads(self) -> set[str]:
        """Return the names of the folders of uploads that jobs wait for."""
        requested = (job.request.get("files") for job in self.jobs(unfinished=True))
        return {str(file["upload"]) for files in requested if isinstance(files, list) for file in files}

    def set_job(self, key: str, **changes: Any) -> Job:
        """Change fields of an unfinished job and return it; a finished job stays as it is.

        Raises:
            Conflict: the job is finished, or another service does it.
        """
        with self._change() as session:
            self.claims.change(session, key, changes)
        return self.job(key)

    def finish_learning(self, key: str, learned: Learned) -> str:
        """Store a run with its paths and mark the job succeeded, all or nothing; return the run's id.

        The id follows from the job's, so that a job which is run again never leaves two runs.
        """
        run, now = f"run-{key.partition('-')[2]}", time.time_ns()
        with self._change() as session:
            self.claims.change(session, key, success(run, now))
            job = session.get_one(JobRow, key)
            paths = tuple(replace(p, id=f"{run}-{p.cluster}", run=run) for p in learned.paths)
            named = replace(learned, paths=paths)
            summary = to_document(Run(run, job.task, now, named).summary)
            document = to_document(named)
            session.add(RunTable(id=run, task=job.task, created_ns=now, summary=summary, document=document))
            session.flush()
            session.add_all(learned_row(path, now) for path in paths)
        return run

    def finish_import(self, key: str, task: Task, batch: Batch) -> str:
        """Take over imported demonstrations with their recordings and mark the job succeeded, all or nothing.

        Those that are stored already stay: after a crash before their rows, the doctor made the rows.

        Args:
            key: of the job.
            task: of the demonstrations; made when it does not exist.
            batch: in their order, one at least; each folder has their recordings at the places that they say.

        Returns:
            The numbers that the first and the last one have now, e.g. `3-5`.
        """
        with self._taking_over(task, batch) as (session, stored):
            numbers = [each.number for each in stored]
            outcome = f"{min(numbers)}-{max(numbers)}"
            self.claims.change(session, key, success(outcome, time.time_ns()))
        return outcome

    def take_over(self, task: Task, batch: Batch) -> list[Demonstration]:
        """Take over demonstrations as `finish_import`, without a job, and return them as they are stored."""
        with self._taking_over(task, batch) as (_, stored):
            return stored

    @contextmanager
    def _taking_over(self, task: Task, batch: Batch) -> Iterator[tuple[Session, list[Demonstration]]]:
        station = self.services.station
        added: dict[Path, list[str]] = {recordings: [] for _, recordings in batch}  # places whose rows are new
        try:
            with self._change() as session:
                yield session, [d for made, of in batch for d in imported_rows(session, task, made, added[of], station)]
                session.flush()
                for recordings, places in added.items():
                    for place in places:
                        self.recordings.take_over(recordings, place)
        except BaseException:
            self.recordings.remove([place for places in added.values() for place in places])
            raise

    def finish_planning(self, key: str, plan: Plan) -> str:
        """Store a plan and mark the job succeeded, all or nothing; return the plan's id."""
        now = time.time_ns()
        with self._change() as session:
            self.claims.change(session, key, success(plan.id, now))
            session.add(PlanRow(id=plan.id, path=plan.path, created_ns=now, document=to_document(plan)))
        return plan.id
