"""Files become demonstrations, through the same cut, account and verdict as a live recording."""

from __future__ import annotations

import time
from dataclasses import dataclass

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.files import Track, read_tracks
from teachpath.io.store import Store
from teachpath.recording import GRASP_BUTTON, RecordingSettings, Segmenter, point_to_world
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
    motions = [_samples(track, source.name) for track in tracks]
    for number, samples in enumerate(motions, 1):
        where = source.name if len(motions) == 1 else f"{source.name}, motion {number} of {len(motions)}"
        _check(samples, settings, scene, calibration, where)
    store.ensure_task(task, scene=scene.name, calibration=calibration.name)
    made: list[tuple[Demonstration, Trajectory]] = []
    for samples in motions:
        session = RecordingSession(
            store, settings, task=task, tracker=source.name, calibration=calibration, scene=scene
        )
        finished = [session.add(sample) for sample in samples]
        made += [f for f in finished if f is not None] + session.finish()
    return made


def _check(
    samples: list[Sample], settings: RecordingSettings, scene: Scene, calibration: Calibration, where: str
) -> None:
    """Refuse a motion that would be no demonstration, before any of its file is stored."""
    carried = scene.carried.position if scene.carried else None
    segmenter = Segmenter(settings, carried)
    mapped = point_to_world(calibration)
    for sample in samples:
        segmenter.push(sample, mapped(sample.position))
    cut = segmenter.finish()
    if cut is None:
        raise UnusableRecording(
            f"{where}: the motion does not begin at the object of scene {scene.name}, at {carried} m; check units and "
            "calibration, or use a scene without an object (empty)"
        )
    if cut.release - cut.grasp < settings.shortest_transport:
        raise UnusableRecording(
            f"{where}: {cut.release - cut.grasp} samples are under the least of {settings.shortest_transport}"
        )


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
