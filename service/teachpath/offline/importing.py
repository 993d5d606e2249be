"""Files become demonstrations, through the same cut, account and verdict as a live recording."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, replace

import numpy as np

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.store.store import Store
from teachpath.motion.arm.model import Arm
from teachpath.offline.file_samples import FileSamples, Source, read_source
from teachpath.offline.import_target import existing_task
from teachpath.recorder.annotations import Annotations
from teachpath.recorder.object_place import ObjectPlace
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.session import RecordingSession
from teachpath.recorder.take import random_id
from teachpath.recording.demonstration import point_to_world
from teachpath.recording.phase_statistics import PhaseStatistics, phase_statistics
from teachpath.recording.phases import Segmenter, TransportSpan
from teachpath.recording.quality import QualityReport, assess_quality, reassess_quality
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Amendment, Calibration, Demonstration, Sample, Scene, StreamStatistics, Trajectory
from teachpath_proto.keys import is_name, name_refusal

MAX_REFUSED = 100_000  # of a file that says so


def import_file(
    store: Store,
    settings: RecordingSettings,
    source: Source,
    *,
    task: str,
    scene: Scene,
    calibration: Calibration,
    limits: ImportSettings,
    arm: Arm | None = None,
    object_at_grasp: bool = False,
    progress: Callable[[float, str], None] = lambda fraction, what: None,
    new_id: Callable[[], str] = random_id,
) -> list[tuple[Demonstration, Trajectory]]:
    """Make a demonstration of each motion in a file; see `samples_of` for its phases.

    A recording of ours (mcap, or a CSV file of samples) brings its own samples, tracker and calibration, is cut as it
    was live, is judged no better than it was, and keeps what an operator said of it: mark, trim, discarded. The task is
    made when it does not exist. The file is read and checked whole before the first one is stored. Joint angles in it
    are those of `arm`. `new_id` returns the id of the next one; in a new task with `object_at_grasp` each motion begins
    at its object.

    Raises:
        UnusableInput: a bad task name, or a file that cannot be used (with its row and column).
    """
    read = read_source(source, calibration, limits, settings, arm)
    return import_samples(
        store,
        settings,
        read,
        source.name,
        task=task,
        scene=scene,
        limits=limits,
        object_at_grasp=object_at_grasp,
        progress=progress,
        new_id=new_id,
    )


def import_samples(
    store: Store,
    settings: RecordingSettings,
    read: FileSamples,
    name: str,
    *,
    task: str,
    scene: Scene,
    limits: ImportSettings,
    object_at_grasp: bool = False,
    progress: Callable[[float, str], None] = lambda fraction, what: None,
    new_id: Callable[[], str] = random_id,
) -> list[tuple[Demonstration, Trajectory]]:
    """Make a demonstration of each motion that was read from the file `name`; as `import_file`."""
    if not is_name(task):
        raise UnusableInput(name_refusal("task", task))
    known = existing_task(store, task)
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
        where = name if len(read.motions) == 1 else f"{name}, motion {number} of {len(read.motions)}"
        _check_duration(samples, limits, where)
        _check(samples, settings, setup, where)
    store.ensure_task(task, scene=scene.name, calibration=read.calibration.name, object_at_grasp=object_at_grasp)
    made = _recorded(store, settings, setup, read, progress)
    if not made:
        raise UnusableRecording(f"{name}: no demonstration came of it; does the hand reach for over a minute?")
    judged = [_judged(store, settings, each, read) for each in made]
    if read.stated is None:
        return judged
    annotations = Annotations(store, settings, lambda _: scene)
    return [_curated(annotations, settings, each, read.stated) for each in judged]


def _recorded(
    store: Store,
    settings: RecordingSettings,
    setup: RecordingSetup,
    read: FileSamples,
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
        for note in read.notes[number] if read.notes else ():
            session.counter.note(note)
        finished = [session.add(sample) for sample in samples]
        took = [f for f in finished if f is not None] + session.finish()
        if read.dwell_times and read.dwell_times[number]:
            took = [(_with_dwells(store, settings, row, read.dwell_times[number]), way) for row, way in took]
        made += took
    return made


def _refused(statistics: StreamStatistics) -> list[int | None]:
    """Return the numbers of the samples that were refused when a file was recorded; None where it is not known."""
    numbers: list[int | None] = []
    for first, last in statistics.refused_numbers:
        numbers += range(first, min(last + 1, first + MAX_REFUSED))
    return (numbers + [None] * max(min(statistics.refused, MAX_REFUSED) - len(numbers), 0))[:MAX_REFUSED]


def _judged(
    store: Store, settings: RecordingSettings, made: tuple[Demonstration, Trajectory], read: FileSamples
) -> tuple[Demonstration, Trajectory]:
    """Keep the reasons that only the recorder could see, e.g. that the tracker was lost in mid-take."""
    stated = read.stated
    if stated is None:
        return made
    row, trajectory = made
    if stated.statistics.dwell_times:
        row = replace(row, statistics=replace(row.statistics, dwell_times=stated.statistics.dwell_times))
    before = _statistics(stated, read.motions[0], settings)
    now = _statistics(row, store.recordings.samples(row.recording, row.digest), settings)
    quality = reassess_quality(QualityReport(stated.verdict, stated.reasons, stated.advice), before, now, settings)
    if quality == QualityReport(made[0].verdict, made[0].reasons, made[0].advice):
        return made
    return store.change_demonstration(row.id, **asdict(quality), statistics=row.statistics), trajectory


def _with_dwells(
    store: Store, settings: RecordingSettings, row: Demonstration, dwell_times: tuple[float, ...]
) -> Demonstration:
    """Reject a demonstration whose taking and putting are not sure, until an operator trims it."""
    statistics = replace(row.statistics, dwell_times=dwell_times)
    now = replace(_statistics(row, store.recordings.samples(row.recording, row.digest), settings), whole=statistics)
    quality = assess_quality(now, settings)
    return store.change_demonstration(row.id, statistics=statistics, **asdict(quality))


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
            f"{where}: the motion does not begin at the object of scene {setup.scene.name}, at {carried} m: "
            f"{segmenter.hint or 'the hand closes nowhere'}; check units and calibration, import it as a new task "
            "whose object lies where the hand grasps, or use a scene without an object (empty)"
        )
    if longest < settings.shortest_transport:
        raise UnusableRecording(f"{where}: {longest} samples are under the least of {settings.shortest_transport}")
    moved = float(np.ptp([mapped(sample.position) for sample in samples if sample.tracked], axis=0).max())
    if moved <= settings.lift:
        raise UnusableRecording(
            f"{where}: the hand moves by {100 * moved:.2g} cm, limit {100 * settings.lift:.2g} cm (recording.lift): it "
            "carries nothing; are the units right?"
        )
