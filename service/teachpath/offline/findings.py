"""What the doctor finds, and what became of it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum, StrEnum


class FaultKind(StrEnum):
    """What is the matter with a file or a row."""

    DATABASE = "database"  # the database contradicts itself
    LEFTOVER = "leftover"  # a temporary file of a process that was killed
    ABANDONED = "abandoned"  # an import that was killed
    TORN = "torn"  # a recording that was never finished
    ORPHANED = "orphaned"  # a finished recording without a row
    DOUBLED = "doubled"  # a second copy of a recording, or a second row of one
    MISSING = "missing"  # a row whose recording is gone
    MOVED = "moved"  # a row whose recording lies elsewhere
    DAMAGED = "damaged"  # a recording that cannot be read to its end, or contradicts itself
    EDITED = "edited"  # a recording that is whole, and not what was recorded
    UNREADABLE = "unreadable"  # a file that may not be read, or a row that says nothing
    UNHASHED = "unhashed"  # a row of before digests were kept


@dataclass(frozen=True, slots=True)
class Finding:
    """One fault, and what became of it.

    Attributes:
        kind: what is the matter.
        file: or row, within the data folder.
        sentence: for the operator: what was found, what was done, what is left to do.
        mended: whether nothing is left to do.
        mendable: whether the doctor knows how to mend it.
        demonstrations: ids of those that were made of it.
        samples: that it holds.
        seconds: from the first of them to the last.
    """

    kind: FaultKind
    file: str
    sentence: str
    mended: bool
    mendable: bool = True
    demonstrations: tuple[str, ...] = ()
    samples: int = 0
    seconds: float = 0.0


class ExitCode(IntEnum):
    """What `teachpath doctor` says to a script; 1 is a refusal, as of every command."""

    WHOLE = 0  # everything is whole, or was mended
    MENDABLE = 3  # a dry run found faults, all of which the doctor mends
    UNMENDED = 4  # some fault is left that a person must see to


def exit_code(findings: Iterable[Finding]) -> ExitCode:
    """Return the exit code of an examination."""
    left = [finding for finding in findings if not finding.mended]
    if not left:
        return ExitCode.WHOLE
    return ExitCode.MENDABLE if all(finding.mendable for finding in left) else ExitCode.UNMENDED
