"""The arms that users brought: every version is kept, the newest one counts."""

from __future__ import annotations

import time

from sqlalchemy import Engine, select
from sqlalchemy.orm import Session

from teachpath.errors import NotFound
from teachpath.io.documents import from_document, to_document
from teachpath.io.store.engine import lock_name
from teachpath.io.store.tables import ArmRow
from teachpath.records import SerialArm, StoredArm


class Arms:
    """The arms of a station; safe to use from several threads."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def add(self, arm: SerialArm, file: str) -> StoredArm:
        """Store the next version of an arm and return it; where the newest one has its hash, that is returned.

        Args:
            arm: with its name.
            file: name of the model's file.
        """
        with Session(self._engine.execution_options(writing=True)) as session, session.begin():
            lock_name(session, "arm", arm.name)
            newest = session.scalar(
                select(ArmRow).where(ArmRow.name == arm.name).order_by(ArmRow.version.desc()).limit(1)
            )
            if newest is not None and newest.hash == arm.hash:
                return from_document(StoredArm, newest.document)
            version = newest.version + 1 if newest is not None else 1
            stored = StoredArm(arm, arm.hash, file, version, time.time_ns())
            session.add(
                ArmRow(
                    name=arm.name,
                    version=version,
                    hash=stored.hash,
                    created_ns=stored.created_ns,
                    document=to_document(stored),
                )
            )
        return stored

    def versions(self, name: str) -> list[StoredArm]:
        """List the versions of an arm, newest first.

        Raises:
            NotFound: there is none of that name.
        """
        with Session(self._engine) as session:
            rows = session.scalars(select(ArmRow).where(ArmRow.name == name).order_by(ArmRow.version.desc()))
            found = [from_document(StoredArm, row.document) for row in rows]
        if not found:
            raise NotFound(f"there is no arm {name!r}; list them with: teachpath arm list")
        return found

    def newest(self) -> list[StoredArm]:
        """List the newest version of each, by name."""
        with Session(self._engine) as session:
            names = session.scalars(select(ArmRow.name).distinct().order_by(ArmRow.name)).all()
        return [self.versions(name)[0] for name in names]
