"""The doctor: finds recordings that a crash left unfinished or without a row, and makes demonstrations of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from teachpath.errors import TeachpathError
from teachpath.io.documents import decode_demonstration
from teachpath.io.store.recordings import read_facts, salvage
from teachpath.io.store.store import Store
from teachpath.offline.lock import StationLock
from teachpath.recorder.session import RecordingSession, RecordingSetup
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Scene

SALVAGED = ".salvaged"


@dataclass(frozen=True, slots=True)
class Finding:
    """One recording that a crash left behind: what it holds and what became of it."""

    file: str
    samples: int
    seconds: float
    demonstrations: tuple[str, ...]
    sentence: str


def examine(store: Store, settings: RecordingSettings, scenes: dict[str, Scene], data_dir: Path) -> list[Finding]:
    """Repair every unfinished recording of a station whose service does not run, and adopt those without a row.

    The samples go through the same cut and verdict as live; the torn file is kept beside the new ones, renamed.

    Raises:
        Conflict: the service is running; its takes are not torn but in progress.
    """
    with StationLock(data_dir):
        known = {d.recording for task in store.tasks() for d in store.demonstrations(task.name)}
        orphans = [file for file in store.recordings.finished() if store.recordings.place(file) not in known]
        adopted = [_adopt(file, store) for file in orphans]
        return adopted + [_repair(part, store, settings, scenes) for part in store.recordings.unfinished()]


def _adopt(file: Path, store: Store) -> Finding:
    """Store the row of a recording that was finished just before the service was cut off."""
    place = store.recordings.place(file)
    try:
        stated = decode_demonstration(read_facts(file).get("demonstration", "").encode())
        store.task(stated.task)
        row = store.add_demonstration(replace(stated, recording=place))
    except TeachpathError as error:
        return Finding(
            place, 0, 0.0, (), f"{place}: it has no row, and its own facts make none ({error}); left as it is"
        )
    sentence = f"{place}: it was whole but for its row; made {row.id}"
    return Finding(place, row.samples, row.duration, (row.id,), sentence)


def _repair(part: Path, store: Store, settings: RecordingSettings, scenes: dict[str, Scene]) -> Finding:
    header, samples, fault = salvage(part)
    name = f"{part.parent.name}/{part.name}"
    if header is None:
        part.rename(part.with_name(part.name + SALVAGED))
        return Finding(name, 0, 0.0, (), f"{name}: nothing could be read ({fault}); kept as {part.name + SALVAGED}")
    seconds = (samples[-1].device_ns - samples[0].device_ns) * 1e-9 if samples else 0.0
    task = store.task(header.task)
    setup = RecordingSetup(header.task, header.tracker, header.calibration, scenes[task.scene])
    session = RecordingSession(store, settings, setup)
    session.counter.note("repaired after the service was cut off; what came after the last flush is missing")
    finished = [session.add(sample) for sample in samples]
    made = [d.id for d, _ in [f for f in finished if f is not None] + session.finish(torn=True)]
    part.rename(part.with_name(part.name + SALVAGED))
    what = f"made {', '.join(made)}" if made else "the hand grasped nothing in it, so there is no demonstration to make"
    return Finding(
        name,
        len(samples),
        seconds,
        tuple(made),
        f"{name}: {len(samples)} samples ({seconds:.1f} s) are whole, at most the last second is missing; {what}",
    )
