"""Every error teachpath raises on purpose.

    TeachpathError
    ├── UnusableInput          what came in cannot be used as it is
    │   ├── UnusableSample     one hand sample: not finite, no unit quaternion, malformed, too large
    │   ├── UnusableRecording  a file or take: empty, truncated, too short, wrong columns
    │   └── UnusableSettings   a setting outside its limits, or one that does not exist
    ├── LearningFailed         no path can be learned from these demonstrations
    ├── PathRefused            the arm cannot follow this path; says where and why
    ├── NotFound               no task, demonstration, run, path, plan, job or execution of that name
    ├── Conflict               busy, already there, or a stale version
    │   ├── Outdated           a newer version was saved meanwhile; carries it
    │   ├── Cancelled          the operator cancelled the job
    │   └── QueueFull          too many jobs wait
    ├── NotSignedIn            nobody knows who asks
    ├── NotAllowed             whoever asks lacks the capability
    ├── TooManyRequests        a subject asks for too much at a time; says when to go on
    │   └── TooManyAttempts    too many sign-ins have failed; says for how long none is tried
    ├── OverLimit              a job takes too much time or memory
    ├── StorageUnavailable     the data folder or the database cannot be read or written now
    │   └── StorageFull        its disk is full
    └── Unreachable            a process or peer does not answer
        ├── Unanswered         it is there, and has not answered in time: it may do later what it was asked for
        └── NotStopped         the executor has not confirmed a stop: the arm may be moving

A message names the value, the limit, the place and the way out.
"""

from __future__ import annotations

from typing import Any


class TeachpathError(Exception):
    """Base of all errors that teachpath raises on purpose; its text is a sentence for the operator."""


class UnusableInput(TeachpathError):
    """What came in cannot be used as it is."""


class UnusableSample(UnusableInput):
    """One hand sample cannot be used.

    Attributes:
        sequence: its number; None: it cannot be read.
    """

    def __init__(self, message: str, *, sequence: int | None = None) -> None:
        super().__init__(message)
        self.sequence: int | None = sequence


class UnusableRecording(UnusableInput):
    """A file or a take cannot be used."""


class UnusableSettings(UnusableInput):
    """A setting is outside its limits or does not exist."""


class LearningFailed(TeachpathError):
    """No path can be learned from these demonstrations; `demonstration` is the id of the one to blame, if it is one."""

    def __init__(self, sentence: str, demonstration: str = "") -> None:
        super().__init__(sentence)
        self.demonstration: str = demonstration


class PathRefused(TeachpathError):
    """The arm cannot follow this path; `failure` says where, why and what to change (a `records.Failure`), if known."""

    def __init__(self, sentence: str, failure: Any = None) -> None:
        super().__init__(sentence)
        self.failure: Any = failure


class NotFound(TeachpathError):
    """There is nothing of that name."""


class Conflict(TeachpathError):
    """The thing is busy, already there, or has changed meanwhile."""


class Outdated(Conflict):
    """What was edited has a newer version, which `newer` holds (a record)."""

    def __init__(self, sentence: str, newer: object) -> None:
        super().__init__(sentence)
        self.newer: object = newer


class Cancelled(Conflict):
    """The operator cancelled the work."""


class QueueFull(Conflict):
    """Too many jobs wait or run.

    Attributes:
        wait: [s] after which to try again.
    """

    wait: float = 10.0


class NotSignedIn(TeachpathError):
    """Nobody knows who asks."""


class NotAllowed(TeachpathError):
    """Whoever asks lacks the capability."""


class TooManyRequests(TeachpathError):
    """A subject asks for too much at a time; it may go on in `wait` seconds."""

    def __init__(self, sentence: str, wait: float) -> None:
        super().__init__(sentence)
        self.wait: float = wait


class TooManyAttempts(TooManyRequests):
    """Too many sign-ins have failed; none is tried for `wait` seconds."""


class OverLimit(TeachpathError):
    """A job takes more time or memory than it may."""


class StorageUnavailable(TeachpathError):
    """The data folder or the database cannot be read or written now."""


class StorageFull(StorageUnavailable):
    """The disk of the data folder or the database is full."""


class Unreachable(TeachpathError):
    """A process or peer does not answer."""


class Unanswered(Unreachable):
    """A process or peer is there and has not answered in time; it may do later what it was asked for."""


class NotStopped(Unreachable):
    """The executor has not confirmed a stop; the arm may be moving."""
