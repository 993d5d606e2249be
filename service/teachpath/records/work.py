"""Background work."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

from teachpath.records.assessments import Failure

JobKindName = Literal["learn", "recut", "plan", "import"]


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
        id: of the job.
        task: name of the task.
        kind: what it does.
        request: what was ordered, as its kind takes it.
        state: where it stands.
        fraction: of the work that is done, 0 to 1.
        message: what it does now, or why it failed.
        outcome: id of the run or plan that it made; of an import the numbers of the first and the last demonstration,
            e.g. `3-5`.
        attempt: how often it was begun; a restart of the service begins it anew.
        created_ns: when it was queued [ns since the Unix epoch].
        finished_ns: when it ended [ns since the Unix epoch]; 0: it has not.
        failure: where a path fails that the arm cannot follow, why, and what to change.
        demonstration: id of the one because of which nothing could be learned.
        who: ordered it, where the station asks.
        station: that it was ordered at.
    """

    id: str
    task: str
    kind: JobKindName
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
    who: str = ""
    station: str = ""
