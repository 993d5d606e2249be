"""What a client raises on purpose.

ClientError
├── Unreachable       no station answers
├── Refused           the station refused a request; carries its answer
├── NotStopped        the executor has not confirmed a stop: the arm may be moving
├── JobFailed         work ended without an outcome; carries the job
├── ExecutionFaulted  the arm has stopped by itself; carries the execution
└── NotInTime         what was waited for has not ended; it goes on
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from teachpath_client.models import Execution, Job, Refusal


class ClientError(Exception):
    """The station cannot be reached, or refused; the text is a sentence for the operator."""


class Unreachable(ClientError):
    """No station answers."""


class Refused(ClientError):
    """The station refused a request.

    Attributes:
        status: of HTTP: 404 not there, 409 busy or changed meanwhile, 422 unusable, 503 a process does not answer.
        refusal: the answer, with the record beside the sentence: `failure`, `newer` or `demonstration`.
    """

    def __init__(self, status: int, refusal: Refusal) -> None:
        super().__init__(refusal.detail)
        self.status: int = status
        self.refusal: Refusal = refusal


class NotStopped(ClientError):
    """The executor has not confirmed a stop; the arm may be moving."""


class JobFailed(ClientError):
    """A job ended without an outcome; `job` says why: `job.message`, `job.failure`, `job.demonstration`."""

    def __init__(self, job: Job) -> None:
        super().__init__(f"{job.kind} {job.state}: {job.message}")
        self.job: Job = job


class ExecutionFaulted(ClientError):
    """The arm has stopped by itself; `execution.status.reason` says why."""

    def __init__(self, execution: Execution) -> None:
        super().__init__(f"the execution faulted: {execution.status.reason}")
        self.execution: Execution = execution


class NotInTime(ClientError):
    """What was waited for has not ended in the time that was given; it goes on."""
