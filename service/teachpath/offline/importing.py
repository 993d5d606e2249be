"""Files become demonstrations, through the same cut, account and verdict as a live recording."""

from __future__ import annotations

import io
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.documents import decode_demonstration
from teachpath.io.files import Track, read_tracks
from teachpath.io.import_settings import ImportSettings
from teachpath.io.sample_files import holds_samples, read_samples
from teachpath.io.store.recordings import read_facts_stream, salvage_stream
from teachpath.io.store.store import Store
from teachpath.recorder.annotations import MARKS, Annotations
from teachpath.recorder.object_place import ObjectPlace
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.session import RecordingSession
from teachpath.recorder.take import random_id
from teachpath.recording.demonstration import point_to_world
from teachpath.recording.phase_statistics import PhaseStatistics, phase_statistics
from teachpath.recording.phases import GRASP_BUTTON, Segmenter, TransportSpan
from teachpath.recording.quality import QualityReport, reassess_quality
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Amendment, Calibration, Demonstration, Sample, Scene, StreamStatistics, Trajectory
from teachpath_proto.keys import is_name, name_refusal

MAX_REFUSED = 100_000  # of a file that says so


@dataclass(frozen=True, slots=True)
class Source:
    """A file to import and how to read it: mcap, or one of the formats of io/files."""

    name: str
    content: bytes
    kind: str = "csv"
    units: str = "m"
    rate: float = 50.0


@dataclass(frozen=True, eq=False)
class _Read:
    """What a file holds: its motions, and what it says of them when it was written here."""

    tracker: str
    calibration: Calibration
    motions: list[list[Sample]]
    stated: Demonstration | None = None


def import_file(
    store: Store,
    settings: RecordingSettings,
    source: Source,
    *,
    task: str,
    scene: Scene,
    calibration: Calibration,
    limits: ImportSettings,
    object_at_grasp: bool = False,
    progress: Callable[[float, str], None] = lambda fraction, what: None,
    new_id: Callable[[], str] = random_id,
) -> list[tuple[Demonstration, Trajectory]]:
    """Make a demonstration of each motion in a file; the whole motion counts as grasped.

    A recording of ours (mcap, or a CSV file of samples) brings its own samples, tracker and calibration, is cut as it
    was live, is judged no better than it was, and keeps what an operator said of it: mark, trim, discarded. The task is
    made when it does not exist. The file is read and checked whole before the first one is stored. `new_id` returns the
    id of the next one; in a new task with `object_at_grasp` each motion begins at its object.

    Raises:
        UnusableInput: a bad task name, or a file that cannot be used (with its row and column).
    """
    if not is_name(task):
        raise UnusableInput(name_refusal("task", task))
    read = _read(source, calibration, limits)
    known = next((one for one in store.tasks() if one.name == task), None)
    stated_pose = read.stated.object_pose if read.stated else None
    setup = RecordingSetup(
        task,
        read.tracker,
        read.calibration,
        scene,
        new_id=new_id,
        reported_object=lambda: stated_pose,
        object_at_grasp=known.object_at_grasp if known else object_at_grasp,
    )
    progress(0.3, f"checking {len(read.motions)} motions")
    for number, samples in enumerate(read.motions, 1):
        where = source.name if len(read.motions) == 1 else f"{source.name}, motion {number} of {len(read.motions)}"
        _check_duration(samples, limits, where)
        _check(samples, settings, setup, where)
    store.ensure_task(task, scene=scene.name, calibration=read.calibration.name, object_at_grasp=object_at_grasp)
    made = _recorded(store, settings, setup, read, progress)
    judged = [_judged(store, settings, each, read) for each in made]
    if read.stated is None:
        return judged
    annotations = Annotations(store, settings, lambda _: scene)
    return [_curated(annotations, settings, each, read.stated) for each in judged]


def _recorded(
    store: Store,
    settings: RecordingSettings,
    setup: RecordingSetup,
    read: _Read,
    progress: Callable[[float, str], None],
) -> list[tuple[Demonstration, Trajectory]]:
    """Record each motion as if live."""
    made: list[tuple[Demonstration, Trajectory]] = []
    for number, samples in enumerate(read.motions):
        progress(0.5 + 0.5 * number / len(read.motions), f"motion {number + 1} of {len(read.motions)}")
        rate = read.stated.statistics.declared_rate if read.stated else 0.0
        session = RecordingSession(store, settings, replace(setup, rate=rate))
        for refused in _refused(read.stated.statistics) if read.stated else ():
            session.counter.count_refused("some samples were refused when it was recorded", refused)
        finished = [session.add(sample) for sample in samples]
        made += [f for f in finished if f is not None] + session.finish()
    return made


def _refused(statistics: StreamStatistics) -> list[int | None]:
    """Return the numbers of the samples that were refused when a file was recorded; None where it is not known."""
    numbers: list[int | None] = []
    for first, last in statistics.refused_numbers:
        numbers += range(first, min(last + 1, first + MAX_REFUSED))
    return (numbers + [None] * max(min(statistics.refused, MAX_REFUSED) - len(numbers), 0))[:MAX_REFUSED]


def _read(source: Source, calibration: Calibration, limits: ImportSettings) -> _Read:
    if source.kind == "mcap":
        return _read_recording(source, limits)
    if source.kind == "csv" and holds_samples(source.content):
        stated, samples = read_samples(source.content, source.name, limits)
        return _Read(stated.source, stated.calibration, [samples], _believed(stated, samples, source.name))
    tracks = read_tracks(source.content, source.name, limits, kind=source.kind, units=source.units, rate=source.rate)
    return _Read(source.name, calibration, [_samples(track, source.name) for track in tracks])


def _read_recording(source: Source, limits: ImportSettings) -> _Read:
    header, samples, fault = salvage_stream(io.BytesIO(source.content), limits)
    if header is None or fault or not samples:
        raise UnusableRecording(
            f"{source.name}: no whole recording of hand samples ({fault or 'there are none in it'}); a torn one that "
            "is still in its data folder can be repaired with: teachpath doctor"
        )
    facts = read_facts_stream(io.BytesIO(source.content)).get("demonstration")
    stated = _believed(decode_demonstration(facts.encode()), samples, source.name) if facts else None
    return _Read(header.tracker, stated.calibration if stated else header.calibration, [samples], stated)


def _believed(stated: Demonstration, samples: list[Sample], name: str) -> Demonstration:
    """Return what a file says of its demonstration, as far as it can be true of its samples."""
    count = len(samples)
    if stated.mark not in MARKS:
        raise UnusableRecording(f"{name}: its mark {stated.mark!r} is none of good, bad and nothing")
    if not 0 <= stated.grasp < stated.release <= count:
        raise UnusableRecording(
            f"{name}: it says that the object was carried from sample {stated.grasp} to {stated.release}, of {count}"
        )
    begin, end = stated.trim or (stated.grasp, stated.release)
    return stated if 0 <= begin < end <= count else replace(stated, trim=None)


def _judged(
    store: Store, settings: RecordingSettings, made: tuple[Demonstration, Trajectory], read: _Read
) -> tuple[Demonstration, Trajectory]:
    """Keep the reasons that only the recorder could see, e.g. that the tracker was lost in mid-take."""
    stated = read.stated
    if stated is None:
        return made
    row, trajectory = made
    before = _statistics(stated, read.motions[0], settings)
    now = _statistics(row, store.recordings.samples(row.recording, row.digest), settings)
    quality = reassess_quality(QualityReport(stated.verdict, stated.reasons, stated.advice), before, now, settings)
    if quality == QualityReport(row.verdict, row.reasons, row.advice):
        return made
    return store.change_demonstration(row.id, **asdict(quality)), trajectory


def _curated(
    annotations: Annotations, settings: RecordingSettings, made: tuple[Demonstration, Trajectory], stated: Demonstration
) -> tuple[Demonstration, Trajectory]:
    """Say again what the operator said where the demonstration was shown; a trim only of the same take."""
    row, trajectory = made
    begin, end = stated.trim or (0, 0)
    same = stated.samples == row.samples and end - begin >= settings.shortest_transport
    trim = stated.trim if same else None
    if not (stated.mark or trim or stated.discarded_ns):
        return made
    amendment = Amendment(mark=stated.mark, discarded=True if stated.discarded_ns else None, trim=trim)
    said = annotations.amend(row.id, amendment)
    return said, annotations.trajectory(said) if trim else trajectory


def _statistics(row: Demonstration, samples: list[Sample], settings: RecordingSettings) -> PhaseStatistics:
    return phase_statistics(samples, TransportSpan(*row.transport), row.statistics, settings)


def _check_duration(samples: list[Sample], limits: ImportSettings, where: str) -> None:
    duration = (max(s.receive_ns for s in samples) - min(s.receive_ns for s in samples)) * 1e-9
    if duration > limits.max_duration:
        raise UnusableRecording(
            f"{where}: it lasts {duration:g} s, limit {limits.max_duration:g} (imports.max_duration); split it"
        )


def _check(samples: list[Sample], settings: RecordingSettings, setup: RecordingSetup, where: str) -> None:
    """Refuse a motion that would be no demonstration, before any of its file is stored."""
    carried = ObjectPlace(setup.scene.carried, setup.reported_object, at_grasp=setup.object_at_grasp).expected
    segmenter = Segmenter(settings, carried)
    mapped = point_to_world(setup.calibration)
    cuts = [segmenter.push(sample, mapped(sample.position)) for sample in samples] + [segmenter.finish()]
    longest = max((cut.release - cut.grasp for cut in cuts if cut is not None), default=None)
    if longest is None:
        raise UnusableRecording(
            f"{where}: the motion does not begin at the object of scene {setup.scene.name}, at {carried} m; check "
            "units and calibration, import it as a new task whose object lies where the hand grasps, or use "
            "a scene without an object (empty)"
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
