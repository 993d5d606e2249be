"""Who did what to the arm, and which certificates were revoked."""

from __future__ import annotations

import time

from sqlalchemy import Engine
from sqlalchemy.orm import Session

from teachpath.io.store.engine import lock_name
from teachpath.io.store.tables import JournalRow, RevocationRow
from teachpath.records import JournalEntry


class Journal:
    """The journal of a station."""

    def __init__(self, engine: Engine) -> None:
        self._engine, self._writing = engine, engine.execution_options(writing=True)

    def write(self, entry: JournalEntry) -> None:
        """Append an entry."""
        fields = {name: getattr(entry, name) for name in JournalEntry.__dataclass_fields__}
        with Session(self._writing) as session, session.begin():
            session.add(JournalRow(**fields))

    def revoke(self, plan: str, *, who: str, reason: str) -> None:
        """Note that the certificate of a stored plan holds no longer; the first reason stays."""
        with Session(self._writing) as session, session.begin():
            lock_name(session, "plan", plan)
            if session.get(RevocationRow, plan) is None:
                session.add(RevocationRow(plan=plan, at_ns=time.time_ns(), who=who, reason=reason))

    def revoked(self, plan: str) -> str:
        """Return why the certificate of a plan holds no longer; empty when it holds."""
        with Session(self._engine) as session:
            row = session.get(RevocationRow, plan)
        return row.reason if row is not None else ""
