"""The services that run on a database: each says again and again that it is alive, and its work is taken up if not."""

from __future__ import annotations

import socket
import time
import uuid
from pathlib import Path
from typing import Final

from sqlalchemy import BigInteger, ColumnElement, Engine, cast, delete, exists, func, inspect, select, true, update
from sqlalchemy.orm import Session

from teachpath.errors import Conflict, UnusableInput
from teachpath.io.store.engine import is_served, lock_name
from teachpath.io.store.object_storage import SCHEME
from teachpath.io.store.tables import DemonstrationRow, ExecutionTable, JobRow, ServiceRow

DEAD_AFTER: Final = 20.0  # [s] without one; longer than a line may be cut without harm
SERVICE, WORKER = "service", "worker"


class Services:
    """This service among those of its station; on SQLite there is none beside it.

    Attributes:
        id: of this service, another one after each start.
        station: name of the station that it works for.
        is_shared: whether other services can work on this database.
        heard_at: when the database last heard that this service is alive, or a little before [s, monotonic].
        taken: why this service has to end: another one is the station's now; empty: none is.
    """

    def __init__(self, engine: Engine, station: str, folder: Path) -> None:
        self.id: str = uuid.uuid4().hex[:12]
        self.station: str = station
        self._engine, self._writing = engine, engine.execution_options(writing=True)
        self._place = _place_of(folder)
        self._role = ""
        self.is_shared: bool = is_served(engine)
        self.heard_at: float = 0.0
        self.taken: str = ""

    def begin(self, role: str = SERVICE) -> None:
        """Say that this service runs, in a role; of `SERVICE` there is one a station.

        Whoever begins has locked the data folder, so that an earlier service there has ended.

        Raises:
            Conflict: another one runs under the name of this station.
        """
        self.heard_at = time.monotonic()
        with Session(self._writing) as session, session.begin():
            if self.is_shared:
                lock_name(session, "services", "")
                if role == SERVICE:
                    self._require_own_name(session)
                session.execute(delete(ServiceRow).where(~_is_alive()))
                session.add(self._row(role))
                self._role = role
            if self.station and role == SERVICE:  # rows of before it had a name are its own
                for table in (DemonstrationRow, JobRow, ExecutionTable):
                    session.execute(update(table).where(table.station == "").values(station=self.station))

    def require_recorded_here(self, task: str) -> None:
        """Raise UnusableInput where a task has demonstrations whose recordings another station keeps."""
        question = select(DemonstrationRow.station, func.count()).where(
            DemonstrationRow.task == task,
            DemonstrationRow.station.not_in(("", self.station)),
            ~DemonstrationRow.document["recording"].as_string().startswith(SCHEME),  # which every station can read
        )
        with Session(self._engine) as session:
            others = session.execute(question.group_by(DemonstrationRow.station)).all()
        if others:
            counts = ", ".join(f"{count} at {station}" for station, count in sorted(others))
            raise UnusableInput(
                f"task {task} has demonstrations whose recordings other stations keep ({counts}); learn it where all "
                "were recorded, or record and import them here"
            )

    def _require_own_name(self, session: Session) -> None:
        former = (ServiceRow.role == SERVICE, ServiceRow.place == self._place)
        session.execute(delete(ServiceRow).where(*former))
        for other in _others(session, self.station, self._place):
            raise Conflict(
                f"{_words(other)}, this one as {self.station!r}; give each station a name of its own (store.station), "
                "end that service, or let this one wait for its end: teachpath serve --standby"
            )

    def note_alive(self) -> None:
        """Say that this service is alive, unless another one has become the station's: then `taken` says which."""
        if not self._role or self.taken:
            return
        began = time.monotonic()
        with Session(self._writing) as session, session.begin():
            row = session.get(ServiceRow, self.id)
            if row is not None:
                session.execute(update(ServiceRow).where(ServiceRow.id == self.id).values(alive_ns=_now_ns()))
            else:  # the line was cut for so long that others count it as dead
                lock_name(session, "services", "")
                if self._role == SERVICE and (other := _others(session, self.station, self._place)):
                    self.taken = f"{_words(other[0])} now; this one did not reach the database for too long, and ends"
                    return
                session.add(self._row(self._role))
        self.heard_at = began

    def end(self) -> None:
        """Say that this service has ended."""
        if not self._role:
            return
        with Session(self._writing) as session, session.begin():
            session.execute(delete(ServiceRow).where(ServiceRow.id == self.id))
        self._role = ""

    def is_left(self) -> ColumnElement[bool]:
        """Return the condition that nobody does a job any more: its service is this one, or has ended."""
        if not self.is_shared:
            return true()
        return ~exists().where(ServiceRow.id == JobRow.service, ServiceRow.id != self.id, _is_alive())

    def _row(self, role: str) -> ServiceRow:
        return ServiceRow(id=self.id, station=self.station, role=role, place=self._place, alive_ns=_now_ns())


def find_holder(engine: Engine, station: str, folder: Path) -> str:
    """Say which service is the station's, from another folder than this one; empty: none is.

    The tables may be of another version, or not there yet.
    """
    if not is_served(engine) or not inspect(engine).has_table(ServiceRow.__tablename__):
        return ""
    with Session(engine) as session:
        return next((_words(other) for other in _others(session, station, _place_of(folder))), "")


def _others(session: Session, station: str, place: str) -> list[ServiceRow]:
    """Return the services that live and take the name of a station from one at a place."""
    living = (ServiceRow.role == SERVICE, ServiceRow.place != place, _is_alive())
    found = session.scalars(select(ServiceRow).where(*living).order_by(ServiceRow.id))
    return [other for other in found if not station or other.station in ("", station)]


def _place_of(folder: Path) -> str:
    return f"{socket.gethostname()}:{folder.absolute()}"


def _words(service: ServiceRow) -> str:
    return f"a service works on this database as station {service.station!r} ({service.place})"


def _now_ns() -> ColumnElement[int]:
    """Return the clock of the server, which is the same for all its services."""
    return cast(func.date_part("epoch", func.clock_timestamp()) * 1e9, BigInteger)


def _is_alive() -> ColumnElement[bool]:
    return ServiceRow.alive_ns > _now_ns() - round(1e9 * DEAD_AFTER)
