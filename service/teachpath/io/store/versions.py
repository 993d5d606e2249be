"""The versions of learned paths: each stays as it was saved, and none is saved over another."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from sqlalchemy import Engine, func, select
from sqlalchemy.orm import Session

from teachpath.errors import NotFound, Outdated, UnusableInput
from teachpath.io.documents import from_document, to_document
from teachpath.io.store.changes import Changed, changing, unheard
from teachpath.io.store.engine import lock_name
from teachpath.io.store.tables import PathRow
from teachpath.nurbs import Curve
from teachpath.records import MAIN_BRANCH, LearnedPath, ObjectPose, Version

MAX_VERSIONS: Final = 10_000  # versions of one path


@dataclass(frozen=True, slots=True)
class Edit:
    """What is said of a version when it is saved.

    Attributes:
        base: number of the version that was edited.
        branch: to continue, or to begin with this version; empty: the branch of `base`.
    """

    base: int
    branch: str = ""
    name: str = ""
    author: str = ""
    note: str = ""


class Versions:
    """The versions of every learned path."""

    def __init__(self, engine: Engine, changed: Changed = unheard) -> None:
        self._engine, self._changed = engine, changed

    def newest(self, path: str, branch: str = MAIN_BRANCH) -> LearnedPath:
        """Return the newest version of a branch; raises NotFound."""
        with Session(self._engine) as session:
            row = _head(session, path, branch)
        if row is None:
            raise NotFound(
                f"there is no path {path!r}" + (f" with a branch {branch!r}" if branch != MAIN_BRANCH else "")
            )
        return from_document(LearnedPath, row.document)

    def get(self, path: str, number: int) -> tuple[Version, LearnedPath]:
        """Return one version and its curve; raises NotFound."""
        with Session(self._engine) as session:
            row = _row(session, path, number)
        return version_of(row), from_document(LearnedPath, row.document)

    def save(
        self,
        path: str,
        curve: Curve,
        edit: Edit,
        *,
        orientation: Curve | None = None,
        object_pose: ObjectPose | None = None,
    ) -> Version:
        """Save an edited curve as the next version of a path, and return it.

        Args:
            path: its id.
            curve: of positions.
            edit: what is said of it.
            orientation: of quaternions; None = that of the base.
            object_pose: where the path takes the object; None = where the base takes it.

        Raises:
            NotFound: there is no such path or base.
            Outdated: the branch has a newer version than the base; nothing was saved.
            UnusableInput: the curve is that of the base.
        """
        with changing(self._engine, self._changed) as session:
            lock_name(session, "path", path)
            base = _row(session, path, edit.base)
            branch = edit.branch or base.branch
            head = _head(session, path, branch)
            if head is not None and head.version != base.version:
                newer = version_of(head)
                raise Outdated(_outdated(newer, edit.base), newer)
            learned = from_document(LearnedPath, base.document)
            turned = orientation is not None and orientation is not learned.orientation
            if head is not None and _same(learned.curve, curve) and not turned:
                raise UnusableInput(f"this is the curve of version {base.version}; edit it, or name another branch")
            number = _next_number(session, path)
            kept = learned.orientation if orientation is None else orientation
            taken = object_pose or learned.object_pose
            edited = replace(
                learned, version=number, curve=curve, fit=None, note="", orientation=kept, object_pose=taken
            )
            row = PathRow(
                id=path,
                version=number,
                run=base.run,
                parent=base.version,
                branch=branch,
                name=edit.name,
                author=edit.author,
                note=edit.note,
                created_ns=time.time_ns(),
                document=to_document(edited),
            )
            session.add(row)
        return version_of(row)


def _next_number(session: Session, path: str) -> int:
    number = 1 + (session.scalar(select(func.max(PathRow.version)).where(PathRow.id == path)) or 0)
    if number > MAX_VERSIONS:
        raise UnusableInput(f"path {path} has {MAX_VERSIONS} versions, which is the limit; learn the task anew")
    return number


def learned_row(path: LearnedPath, created_ns: int) -> PathRow:
    """Return the row of a path as it was learned: the first version on the main branch."""
    return PathRow(
        id=path.id,
        version=path.version,
        run=path.run,
        parent=None,
        branch=MAIN_BRANCH,
        name="learned",
        author="",
        note="",
        created_ns=created_ns,
        document=to_document(path),
    )


def version_of(row: PathRow) -> Version:
    """Return the version of a row."""
    facts = ("parent", "branch", "name", "author", "note", "created_ns")
    return Version(path=row.id, number=row.version, **{fact: getattr(row, fact) for fact in facts})


def _row(session: Session, path: str, number: int) -> PathRow:
    if "\0" in path:
        raise NotFound(f"there is no path {path!r}")
    row = session.get(PathRow, (path, number)) if 0 < number <= MAX_VERSIONS else None
    if row is None:
        newest = session.scalar(select(func.max(PathRow.version)).where(PathRow.id == path))
        if newest is None:
            raise NotFound(f"there is no path {path!r}")
        raise NotFound(f"there is no version {number} of path {path!r}; it has 1 to {newest}")
    return row


def _head(session: Session, path: str, branch: str) -> PathRow | None:
    if "\0" in path + branch:  # which no database with a server keeps, nor asks for
        return None
    of_branch = select(PathRow).where(PathRow.id == path, PathRow.branch == branch)
    return session.scalar(of_branch.order_by(PathRow.version.desc()).limit(1))


def _outdated(newer: Version, base: int) -> str:
    who = f" by {newer.author}" if newer.author else ""
    name = f" ({newer.name})" if newer.name else ""
    return (
        f"version {newer.number}{name} was saved on branch {newer.branch} meanwhile{who}, and your edit began at "
        f"version {base}; save yours on a branch of its own, or go on from version {newer.number}"
    )


def _same(a: Curve, b: Curve) -> bool:
    pairs = ((a.knots, b.knots), (a.control_points, b.control_points), (a.weights, b.weights))
    return a.degree == b.degree and all(np.array_equal(x, y) for x, y in pairs)
