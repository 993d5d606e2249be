"""How a job or an execution stands, as the events of it say: nobody has to ask after each."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from teachpath.errors import TeachpathError
from teachpath.records import JobKindName, JobState
from teachpath_proto.control import ExecutorState

if TYPE_CHECKING:
    from teachpath.io.store.store import Store


@dataclass(frozen=True, slots=True)
class JobStatus:
    """How a job stands.

    Attributes:
        task: name of its task.
        kind: what it does.
        state: where it stands.
        fraction: of the work that is done, 0 to 1.
        message: what it does now, or why it failed.
        outcome: what it made, as the job says; empty: nothing yet.
    """

    task: str
    kind: JobKindName
    state: JobState
    fraction: float
    message: str
    outcome: str


@dataclass(frozen=True, slots=True)
class ExecutionStatus:
    """How an execution stands; while it is under way, the events of topic `executor` say more, and sooner.

    Attributes:
        plan: id of the plan; null: the arm follows a live hand.
        state: what it does, or how it ended.
        reason: why it is held, stopped or faulted, in words; empty otherwise.
    """

    plan: str | None
    state: ExecutorState
    reason: str


def status_of(store: Store, table: str, key: str) -> dict[str, Any] | None:
    """Return how a job or an execution stands, as a document; None: it is neither, or cannot be read now."""
    try:
        if table == "jobs":
            job = store.job(key)
            return asdict(JobStatus(job.task, job.kind, job.state, job.fraction, job.message, job.outcome))
        if table == "executions":
            execution = store.execution(key)
            return asdict(ExecutionStatus(execution.plan, execution.status.state, execution.status.reason))
    except TeachpathError:
        pass  # whoever hears of it asks, and is told why
    return None
