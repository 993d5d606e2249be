"""Files that were imported before: whoever imports one again is told, for what is shown once then counts twice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sqlalchemy import Engine, or_, select
from sqlalchemy.orm import Session

from teachpath.io.store.tables import DemonstrationRow
from teachpath.records import Demonstration


class ImportedFiles:
    """Knows of the files that demonstrations were made from."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def imported_before(self, task: str, sha256: str) -> str:
        """Say that a file of this SHA-256 was imported into a task before; empty: it was not."""
        with Session(self._engine) as session:
            return _sentence(task, _numbers(session, task, sha256, ()))


def with_note(session: Session, made: Sequence[Demonstration]) -> list[Demonstration]:
    """Return the demonstrations of a file, with a note where it was imported into their task before."""
    files = {(each.task, each.source_sha256): [one.id for one in made] for each in made}
    said = {of: _sentence(of[0], _numbers(session, *of, ids)) for of, ids in files.items()}
    return [_noted(each, said[each.task, each.source_sha256]) for each in made]


def _numbers(session: Session, task: str, sha256: str, but: Sequence[str]) -> list[int]:
    """Return the numbers of a task's other demonstrations of a file, made from it or recorded in it; not discarded."""
    if not sha256:
        return []
    document = DemonstrationRow.document
    same = or_(document["source_sha256"].as_string() == sha256, document["digest"]["sha256"].as_string() == sha256)
    of_task = select(DemonstrationRow).where(DemonstrationRow.task == task, DemonstrationRow.id.not_in(but))
    rows = session.scalars(of_task.where(same).order_by(DemonstrationRow.number))
    return [row.number for row in rows if not row.document["discarded_ns"]]


def _sentence(task: str, numbers: list[int]) -> str:
    if not numbers:
        return ""
    listed = ", ".join(map(str, numbers[:10])) + (", ..." if numbers[10:] else "")
    return (
        f"the same file was imported into {task} before, as {listed}: what it shows counts twice; discard one of them"
    )


def _noted(demonstration: Demonstration, note: str) -> Demonstration:
    statistics = demonstration.statistics
    if not note:
        return demonstration
    return replace(demonstration, statistics=replace(statistics, notes=(*statistics.notes, note)))
