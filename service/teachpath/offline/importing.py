"""Files become demonstrations, through the same cut, account and verdict as a live recording."""

from __future__ import annotations

import io
import time
from dataclasses import dataclass

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.files import Track, read_tracks
from teachpath.io.store import Store
from teachpath.io.store.recordings import salvage_stream
from teachpath.recording import GRASP_BUTTON, RecordingSettings, Segmenter, point_to_world
from teachpath.records import Calibration, Demonstration, Sample, Scene, Trajectory
from teachpath.workers.session import RecordingSession
from teachpath_proto.keys import is_name


@dataclass(frozen=True, slots=True)
class Source:
    """A file to import and how to read it: mcap, or one of the formats of io/files."""

    name: str
    content: bytes
    kind: str = "csv"
    units: str = "m"
    rate: float = 50.0


def import_file(
    store: Store, settings: RecordingSettings, source: Source, *, task: str, scene: Scene, calibration: Calibration
) -> list[tuple[Demonstration, Trajectory]]:
    """Make a demonstration of each motion in a file; the whole motion counts as grasped.

    A recording (mcap) brings its own samples, tracker and calibration, and is cut as it was live. The task is made
    when it does not exist. The file is read and checked whole before the first one is stored.

    Raises:
        UnusableInput: a bad task name, or a file that cannot be used (with its row and column).
    """
    if not is_name(task):
        raise UnusableInput(f"{task!r} cannot name a task: use letters, digits, '.', '_' or '-', at most 64")
    if source.kind == "mcap":
        tracker, calibration, motions = _read_recording(source)
    else:
        tracks = read_tracks(source.content, source.name, kind=source.kind, units=source.units, rate=source.rate)
        tracker, motions = source.name, [_samples(track, source.name) for track in tracks]
    for number, samples in enumerate(motions, 1):
        where = source.name if len(motions) == 1 else f"{source.name}, motion {number} of {len(motions)}"
        _check(samples, settings, scene, calibration, where)
    store.ensure_task(task, scene=scene.name, calibration=calibration.name)
    made: list[tuple[Demonstration, Trajectory]] = []
    for samples in motions:
        session = RecordingSession(store, settings, task=task, tracker=tracker, calibration=calibration, scene=scene)
        finished = [session.add(sample) for sample in samples]
        made += [f for f in finished if f is not None] + session.finish()
    return made


def _read_recording(source: Source) -> tuple[str, Calibration, list[list[Sample]]]:
    """Return the tracker, the calibration and the samples of a recording, as they were received then."""
    header, samples, fault = salvage_stream(io.BytesIO(source.content))
    if header is None or fault or not samples:
        raise UnusableRecording(
            f"{source.name}: no whole recording of hand samples ({fault or 'there are none in it'}); a torn one that "
            "is still in its data folder can be repaired with: teachpath doctor"
        )
    return header.tracker, header.calibration, [samples]


def _check(
    samples: list[Sample], settings: RecordingSettings, scene: Scene, calibration: Calibration, where: str
) -> None:
    """Refuse a motion that would be no demonstration, before any of its file is stored."""
    carried = scene.carried.position if scene.carried else None
    segmenter = Segmenter(settings, carried)
    mapped = point_to_world(calibration)
    cuts = [segmenter.push(sample, mapped(sample.position)) for sample in samples] + [segmenter.finish()]
    longest = max((cut.release - cut.grasp for cut in cuts if cut is not None), default=None)
    if longest is None:
        raise UnusableRecording(
            f"{where}: the motion does not begin at the object of scene {scene.name}, at {carried} m; check units and "
            "calibration, or use a scene without an object (empty)"
        )
    if longest < settings.shortest_transport:
        raise UnusableRecording(f"{where}: {longest} samples are under the least of {settings.shortest_transport}")


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
