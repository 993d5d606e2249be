"""Where jobs are worked on: what every place can do, whether it is a process of this machine or a cluster."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol


@dataclass(frozen=True)
class Limits:
    """What a job may take: memory beside its libraries [bytes], and time [s]."""

    memory: int
    duration: float


@dataclass(frozen=True)
class Work:
    """The steps of a job; only the middle one may be done on another machine.

    Attributes:
        function: does the work: `function(*inputs, progress=...)`.
        load: makes of the inputs those of `function`, here, where recordings can be read; None: they are.
        conclude: makes of what `function` made and the first inputs the outcome, here, where the station's keys are;
            None: it is.
    """

    function: Callable[..., Any]
    load: Callable[..., tuple[Any, ...]] | None = None
    conclude: Callable[..., Any] | None = None


class Reports(Protocol):
    """Takes the reports of jobs, from several threads."""

    def put(self, report: tuple[str, float, str]) -> None:
        """Take a report: key of the job, fraction, sentence."""


class JobExecutor(Protocol):
    """Works on one job at a time."""

    def begin(self) -> None:
        """Begin to load what jobs need, and return at once."""

    def renew(self) -> None:
        """Forget that the job before was cancelled."""

    def work(self, key: str, work: Work, inputs: tuple[Any, ...]) -> Any:
        """Return the outcome of job `key`; its progress goes where the executor was told.

        Raises:
            Cancelled: the job was cancelled, or the executor was closed.
            OverLimit: it took too much time or memory.
            BrokenProcessPool: the process or machine that worked on it died.
            UnusableSettings: nobody who could work on it has the versions of this service.
        """

    def cancel(self) -> None:
        """Cancel the job under way, or the next one."""

    def close(self) -> None:
        """Stop at once, even in the middle of a job; no other is begun."""
