"""The calibrations that were measured: every version is kept, the newest one counts."""

from __future__ import annotations

import time
from dataclasses import replace

from sqlalchemy import Engine, func, select
from sqlalchemy.orm import Session

from teachpath.errors import NotFound
from teachpath.io.documents import from_document, to_document
from teachpath.io.store.engine import lock_name
from teachpath.io.store.tables import CalibrationRow
from teachpath.records import MeasuredCalibration


class MeasuredCalibrations:
    """The measured calibrations of a station; safe to use from several threads."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def add(self, measured: MeasuredCalibration) -> MeasuredCalibration:
        """Store the next version of a calibration and return it with its number and date."""
        name = measured.calibration.name
        with Session(self._engine.execution_options(writing=True)) as session, session.begin():
            lock_name(session, "calibration", name)
            newest = session.scalar(select(func.max(CalibrationRow.version)).where(CalibrationRow.name == name))
            stored = replace(measured, version=(newest or 0) + 1, created_ns=time.time_ns())
            session.add(
                CalibrationRow(
                    name=name, version=stored.version, created_ns=stored.created_ns, document=to_document(stored)
                )
            )
        return stored

    def versions(self, name: str) -> list[MeasuredCalibration]:
        """List the versions of one calibration, newest first; none when it was never measured."""
        with Session(self._engine) as session:
            rows = session.scalars(
                select(CalibrationRow).where(CalibrationRow.name == name).order_by(CalibrationRow.version.desc())
            )
            return [from_document(MeasuredCalibration, row.document) for row in rows]

    def newest(self) -> list[MeasuredCalibration]:
        """List the newest version of each, by name."""
        with Session(self._engine) as session:
            names = session.scalars(select(CalibrationRow.name).distinct().order_by(CalibrationRow.name)).all()
        return [self.versions(name)[0] for name in names]

    def version(self, name: str, version: int) -> MeasuredCalibration:
        """Return one version; raises NotFound."""
        for measured in self.versions(name):
            if measured.version == version:
                return measured
        raise NotFound(f"there is no version {version} of the calibration {name!r}")
