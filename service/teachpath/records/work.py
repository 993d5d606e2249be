"""Background work."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from teachpath.records.assessments import Failure


class JobState(StrEnum):
    """The life of a job."""

    QUEUED = "queued"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"


@dataclass(frozen=True, slots=True)
class Job:
    """Background work on a task: `learn`, `recut`, `plan` or `import`.

    Attributes:
        message: what it does now, or why it failed.
        outcome: id of the run or plan that it made; of an import the numbers of the first and the last
            demonstration, e.g. `3-5`.
        failure: where a path fails that the arm cannot follow, why, and what to change.
        demonstration: id of the one because of which nothing could be learned.
    """

    id: str
    task: str
    kind: str
    request: dict[str, object]
    state: JobState
    fraction: float
    message: str
    outcome: str
    attempt: int
    created_ns: int
    finished_ns: int
    failure: Failure | None = None
    demonstration: str = ""
