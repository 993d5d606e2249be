"""Background work."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class JobState(StrEnum):
    """The life of a job."""

    QUEUED = "queued"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"


@dataclass(frozen=True, slots=True)
class Job:
    """Background work on a task: `learn`, `recut` or `plan`. `outcome` is the id of the run or plan it made."""

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
