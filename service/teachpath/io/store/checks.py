"""Whether the rows are in order: what the doctor asks of a database."""

from __future__ import annotations

from collections.abc import Iterator

from sqlalchemy import Engine, select
from sqlalchemy.orm import Session

from teachpath.errors import UnusableInput
from teachpath.io.store.object_storage import SCHEME
from teachpath.io.store.rows import demonstration_of
from teachpath.io.store.tables import DemonstrationRow
from teachpath.records import Demonstration


class Checks:
    """Looks at all rows of a station, also where they are wrong."""

    def __init__(self, engine: Engine, station: str) -> None:
        self._engine = engine
        self._own = DemonstrationRow.station.in_(("", station))  # the recordings of others are not here

    def contradictions(self) -> list[str]:
        """Say in which ways a SQLite database contradicts itself; of a database with a server, nothing."""
        if self._engine.dialect.name != "sqlite":
            return []
        with self._engine.connect() as connection:
            found = [str(row[0]) for row in connection.exec_driver_sql("PRAGMA quick_check(20)")]
            orphans = connection.exec_driver_sql("PRAGMA foreign_key_check").all()
        return [sentence for sentence in found if sentence != "ok"] + [
            f"row {row} of {table} names a row of {parent} that is not there" for table, row, parent, _ in orphans
        ]

    def named_recordings(self, *, everywhere: bool = False) -> set[str]:
        """Return the places or addresses of the recordings that rows of this station name, or those of all stations."""
        question = select(DemonstrationRow.document["recording"].as_string())
        with Session(self._engine) as session:
            return set(session.scalars(question if everywhere else question.where(self._own)))

    def places(self) -> dict[str, str]:
        """Return the ids of this station's demonstrations by the places of their recordings in the data folder."""
        place = DemonstrationRow.document["recording"].as_string()
        question = select(place, DemonstrationRow.id).where(self._own, ~place.startswith(SCHEME))
        with Session(self._engine) as session:
            return {row[0]: row[1] for row in session.execute(question)}

    def demonstrations(self) -> Iterator[tuple[str, Demonstration | str]]:
        """Yield the station's demonstrations by their ids, by task and number; why, where a row says nothing."""
        question = select(DemonstrationRow).where(self._own).order_by(DemonstrationRow.task, DemonstrationRow.number)
        with Session(self._engine) as session:
            rows = list(session.scalars(question))
            session.expunge_all()
        for row in rows:
            try:
                yield row.id, demonstration_of(row)
            except UnusableInput as error:
                yield row.id, str(error)
