"""Data folders of a station, whole and damaged."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path

from teachpath.io.documents import to_document
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.doctor import examine
from teachpath.offline.findings import Finding
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.session import RecordingSession
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Demonstration, Scene, Shape
from tests.contract import rows
from tests.unit.recording.hands import demonstration

SCENE = Scene("paper", (), Shape("block", "box", (0.04, 0.04, 0.04), (0.5, 0.0, 0.48)))
SETTINGS = RecordingSettings()
TASK = "lift"
SAMPLE_COUNT = 110  # samples of one demonstration


@contextmanager
def opened(data: Path) -> Iterator[Store]:
    store = Store(StoreSettings(data_dir=str(data)))
    try:
        yield store
    finally:
        store.close()


def make_station(data: Path, takes: int = 3, *, torn: int = 0) -> list[Demonstration]:
    """Record so many demonstrations, and leave one that is torn after `torn` samples, if any."""
    with opened(data) as store:
        store.ensure_task(TASK, scene=SCENE.name, calibration="identity")
        ids = iter([f"demo-{number}" for number in range(1, takes + 2)])
        setup = RecordingSetup(TASK, "glove", Calibration("identity"), SCENE, new_id=lambda: next(ids, "demo-torn"))
        session = RecordingSession(store, SETTINGS, setup)
        for take in range(takes):
            for sample in demonstration(1 + take * SAMPLE_COUNT):
                session.add(sample)
        session.finish()
        if torn:
            broken = RecordingSession(store, SETTINGS, replace(setup, new_id=lambda: "demo-torn"))
            for sample in demonstration(1 + takes * SAMPLE_COUNT)[:torn]:
                broken.add(sample)
            broken.flush(0.0)
            broken.fail("the service was killed")
        return store.demonstrations(TASK)


def file_of(data: Path, row: Demonstration) -> Path:
    return data / "recordings" / row.recording


def examined(data: Path, **options: object) -> list[Finding]:
    with opened(data) as store:
        return examine(store, SETTINGS, {}, data, **options)  # type: ignore[arg-type]


def rows_of(data: Path) -> list[Demonstration]:
    with opened(data) as store:
        return store.demonstrations(TASK)


def drop_row(data: Path, key: str) -> None:
    with closing(sqlite3.connect(data / "teachpath.sqlite")) as database:
        database.execute("DELETE FROM demonstrations WHERE id = ?", (key,))
        database.commit()


def flip(file: Path, place: int) -> None:
    content = bytearray(file.read_bytes())
    content[place] ^= 1
    file.write_bytes(content)


def contradictions(data: Path) -> list[str]:
    """Say what is wrong with a folder that the doctor has mended: every sample read, every row and file once."""
    with opened(data) as store:
        rows = store.demonstrations(TASK)
        found = [
            f"{row.id} has {row.samples} samples, its file another count"
            for row in rows
            if len(store.recordings.samples(row.recording, row.digest)) != row.samples or row.digest is None
        ]
        places = sorted(row.recording for row in rows)
        if places != sorted(map(store.recordings.place, store.recordings.finished())):
            found.append(f"rows {places}, other files")
        if [row.number for row in rows] != list(range(1, len(rows) + 1)):
            found.append("numbers are not 1 to n")
        return found + [f"left: {part.name}" for part in store.recordings.unfinished()]


def change_row(data: Path, key: str, row: Demonstration) -> None:
    with opened(data) as store:
        document = to_document(row)
        store.change_demonstration(key, **{name: getattr(row, name) for name in document})


def make_row(key: str) -> Demonstration:
    return rows.demonstration(key, task=TASK, recording=f"{TASK}/{key}.mcap")
