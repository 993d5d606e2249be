"""The doctor: finds recordings that a crash left unfinished, says what they hold, and makes demonstrations of them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from teachpath.io.store import Store
from teachpath.io.store.recordings import salvage
from teachpath.offline.lock import StationLock
from teachpath.recording import RecordingSettings
from teachpath.records import Scene
from teachpath.workers.session import RecordingSession

SALVAGED = ".salvaged"


@dataclass(frozen=True, slots=True)
class Finding:
    """One unfinished recording: what it holds and what became of it."""

    file: str
    samples: int
    seconds: float
    demonstrations: tuple[str, ...]
    sentence: str


def examine(store: Store, settings: RecordingSettings, scenes: dict[str, Scene], data_dir: Path) -> list[Finding]:
    """Repair every unfinished recording of a station whose service does not run.

    The samples go through the same cut and verdict as live; the torn file is kept beside the new ones, renamed.

    Raises:
        Conflict: the service is running; its takes are not torn but in progress.
    """
    with StationLock(data_dir):
        return [_repair(part, store, settings, scenes) for part in store.recordings.unfinished()]


def _repair(part: Path, store: Store, settings: RecordingSettings, scenes: dict[str, Scene]) -> Finding:
    header, samples, fault = salvage(part)
    name = f"{part.parent.name}/{part.name}"
    if header is None:
        part.rename(part.with_name(part.name + SALVAGED))
        return Finding(name, 0, 0.0, (), f"{name}: nothing could be read ({fault}); kept as {part.name + SALVAGED}")
    seconds = (samples[-1].device_ns - samples[0].device_ns) * 1e-9 if samples else 0.0
    task = store.task(header.task)
    session = RecordingSession(
        store,
        settings,
        task=header.task,
        tracker=header.tracker,
        calibration=header.calibration,
        scene=scenes[task.scene],
    )
    session.remark("repaired after the service was cut off; what came after the last flush is missing")
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
