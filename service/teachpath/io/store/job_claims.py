"""Which service does which job: each is claimed in its row, and done by one at a time, however many want it."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any, Final

from sqlalchemy import Engine, or_, select, update
from sqlalchemy.orm import Session

from teachpath.errors import Conflict, NotFound
from teachpath.io.store.changes import Changed, changing, note
from teachpath.io.store.rows import job_of
from teachpath.io.store.services import Services
from teachpath.io.store.tables import JobRow
from teachpath.records import Job, JobState

UNFINISHED_STATES: Final = (JobState.QUEUED.value, JobState.RUNNING.value)
CANCELLED_EARLY: Final = "cancelled before it began"


class JobClaims:
    """Claims jobs of a station for one of its services."""

    def __init__(self, engine: Engine, services: Services, changed: Changed) -> None:
        self._engine, self._services, self._changed = engine, services, changed

    def waiting(self, kinds: Sequence[str]) -> list[Job]:
        """List the station's jobs of some kinds that nobody does, oldest first."""
        question = select(JobRow).where(self._is_free(), JobRow.kind.in_(kinds))
        with Session(self._engine) as session:
            return [job_of(row) for row in session.scalars(question.order_by(JobRow.created_ns, JobRow.id))]

    def claim(self, key: str) -> Job | None:
        """Return a job that nobody does, as this service's from now on; None: it has ended, or somebody does it.

        One that was to be cancelled while its service died has ended now.
        """
        question = select(JobRow).where(JobRow.id == key, self._is_free())
        with changing(self._engine, self._changed) as session:
            row = session.scalar(question.with_for_update(skip_locked=True))
            if row is None:
                return None
            if row.cancel:
                row.state, row.message, row.finished_ns = JobState.CANCELLED.value, CANCELLED_EARLY, time.time_ns()
                return None
            row.state, row.service, row.attempt = JobState.RUNNING.value, self._services.id, max(row.attempt, 1)
        return job_of(row)

    def give_back(self, keys: Sequence[str]) -> None:
        """Let others do jobs that this service has begun and not finished."""
        ours = (JobRow.id.in_(keys), JobRow.service == self._services.id, JobRow.state == JobState.RUNNING.value)
        with changing(self._engine, self._changed) as session:
            for row in session.scalars(select(JobRow).where(*ours).with_for_update()):
                row.state, row.service = JobState.QUEUED.value, ""

    def cancel(self, key: str) -> Job:
        """Cancel a queued job, or ask the service that does it to; raises NotFound, Conflict when it has ended."""
        with changing(self._engine, self._changed) as session:
            row = session.get(JobRow, key, with_for_update=True)
            if row is None or row.state not in UNFINISHED_STATES:
                raise _refusal(row, key)
            left = session.scalar(select(JobRow.id).where(JobRow.id == key, self._services.is_left()))
            if row.state == JobState.QUEUED.value or left:
                row.state, row.message, row.finished_ns = JobState.CANCELLED.value, CANCELLED_EARLY, time.time_ns()
            row.cancel = True
        return job_of(row)

    def to_break_off(self, keys: Sequence[str]) -> list[str]:
        """Return those of the jobs of this service that somebody has cancelled, or that another service does now.

        What a dead service left is none of them: this one may be about to claim it.
        """
        if not keys:
            return []
        cancelled = JobRow.cancel & JobRow.state.in_(UNFINISHED_STATES)
        elsewhere = JobRow.service.not_in(("", self._services.id)) & ~self._services.is_left()
        with Session(self._engine) as session:
            return list(session.scalars(select(JobRow.id).where(JobRow.id.in_(keys), cancelled | elsewhere)))

    def change(self, session: Session, key: str, changes: dict[str, Any]) -> None:
        """Change an unfinished job that no other service does; raises NotFound, Conflict."""
        ours = JobRow.service.in_(("", self._services.id))
        free = (JobRow.id == key, JobRow.state.in_(UNFINISHED_STATES), ours)
        changed = session.execute(update(JobRow).where(*free).values(changes))
        if changed.rowcount == 0:  # type: ignore[attr-defined]
            raise _refusal(session.get(JobRow, key), key)
        note(session, JobRow.__tablename__, key)

    def _is_free(self) -> Any:
        left = (JobRow.state == JobState.RUNNING.value) & self._services.is_left()
        return (JobRow.station == self._services.station) & or_(JobRow.state == JobState.QUEUED.value, left)


def _refusal(row: JobRow | None, key: str) -> NotFound | Conflict:
    if row is None:
        return NotFound(f"there is no job {key!r}")
    if row.state in UNFINISHED_STATES:
        return Conflict(f"job {key} is done by another service now")
    return Conflict(f"job {key} has already {row.state}")
