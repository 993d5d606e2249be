"""Files become demonstrations, through the same cut, account and verdict as a live recording."""

from __future__ import annotations

import time
from dataclasses import dataclass

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.files import Track, read_tracks
from teachpath.io.store import Store
from teachpath.recording import GRASP_BUTTON, RecordingSettings
from teachpath.records import Calibration, Demonstration, Sample, Scene, Trajectory
from teachpath.workers.session import RecordingSession
from teachpath_proto.keys import is_name


@dataclass(frozen=True, slots=True)
class Source:
    """A file to import and how to read it; see io/files for the formats."""

    name: str
    content: bytes
    kind: str = "csv"
    units: str = "m"
    rate: float = 50.0


def import_file(
    store: Store, settings: RecordingSettings, source: Source, *, task: str, scene: Scene, calibration: Calibration
) -> list[tuple[Demonstration, Trajectory]]:
    """Make a demonstration of each motion in a file; the whole motion counts as grasped.

    The task is made when it does not exist. The file is read and checked whole before the first one is stored.

    Raises:
        UnusableInput: a bad task name, or a file that cannot be used (with its row and column).
    """
    if not is_name(task):
        raise UnusableInput(f"{task!r} cannot name a task: use letters, digits, '.', '_' or '-', at most 64")
    tracks = read_tracks(source.content, source.name, kind=source.kind, units=source.units, rate=source.rate)
    store.ensure_task(task, scene=scene.name, calibration=calibration.name)
    made: list[tuple[Demonstration, Trajectory]] = []
    for number, track in enumerate(tracks, 1):
        session = RecordingSession(
            store, settings, task=task, tracker=source.name, calibration=calibration, scene=scene
        )
        finished = [session.add(sample) for sample in _samples(track, source.name)]
        made += [f for f in finished if f is not None] + session.finish()
        if len(made) < number:
            raise UnusableRecording(_why_not(session, source.name, number, len(tracks), scene))
    return made


def _samples(track: Track, name: str) -> list[Sample]:
    start_ns = time.time_ns()
    samples = []
    for i, (t, position) in enumerate(zip(track.times, track.positions, strict=True)):
        stamp = start_ns + round(t * 1e9)
        x, y, z = position.tolist()
        q = None
        if track.orientations is not None:
            w, i_, j, k = track.orientations[i].tolist()
            q = (w, i_, j, k)
        samples.append(Sample(name, i + 1, stamp, stamp, (x, y, z), q, (), True, GRASP_BUTTON))
    return samples


def _why_not(session: RecordingSession, name: str, number: int, count: int, scene: Scene) -> str:
    notes = "; ".join(session.account.account().notes)
    if not notes and scene.carried is not None:
        notes = (
            f"the motion does not begin at the object of scene {scene.name}, at {scene.carried.position} m; "
            "check units and calibration, or use a scene without an object (empty)"
        )
    return f"{name}: motion {number} of {count} is no demonstration: {notes}"
