"""What a file holds as samples: a recording of ours with what it says of itself, or what a reader finds."""

from __future__ import annotations

import io
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from teachpath.errors import UnusableRecording
from teachpath.io.documents import decode_demonstration
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.bags import is_bag
from teachpath.io.readers.contract import Progress, ReadOptions, Track, unheard
from teachpath.io.readers.registry import read_motions, recognized
from teachpath.io.sample_files import holds_samples, read_samples
from teachpath.io.store.recording_facts import read_facts_stream
from teachpath.io.store.salvage import salvage_stream
from teachpath.motion.arm.model import Arm
from teachpath.offline.recorded_arm import kinematics_of
from teachpath.offline.track_samples import MotionMarks, PhaseMarks, samples_of
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Demonstration, Sample

MCAP_MAGIC = b"\x89MCAP0\r\n"


@dataclass(frozen=True, slots=True)
class Source:
    """A file to import and how to read it.

    Attributes:
        content: of the file; its beginning is enough where its format is read from the disk.
        kind: mcap (a recording of ours), or the name of a reader; empty: what the file has.
        options: what the user says of its format.
        marks: what the user says of the phases of its motions.
        motion_marks: of single motions, before those.
        file: where it lies; None: it is in memory alone.
    """

    name: str
    content: bytes
    kind: str = ""
    options: ReadOptions = field(default_factory=ReadOptions)
    marks: PhaseMarks = field(default_factory=PhaseMarks)
    motion_marks: tuple[MotionMarks, ...] = ()
    file: Path | None = None


@dataclass(frozen=True, eq=False)
class FileSamples:
    """What a file holds: its motions, and what it says of them when it was written here.

    Attributes:
        format: of the file: mcap, or the name of a reader.
        understood: what was taken for time, units and phases.
        choices: names of the bodies, markers or topics of which one was read; empty: there is no choice.
        dwell_times: of each motion; not empty: it is not sure which dwells are taking and putting.
        notes: of each motion, for the operator.
    """

    tracker: str
    calibration: Calibration
    motions: list[list[Sample]]
    stated: Demonstration | None = None
    format: str = "mcap"
    understood: tuple[str, ...] = ()
    choices: tuple[str, ...] = ()
    dwell_times: tuple[tuple[float, ...], ...] = ()
    notes: tuple[tuple[str, ...], ...] = ()

    def only(self, motion: int) -> FileSamples:
        """Return the same with one of its motions, by its number from 1."""
        one = slice(motion - 1, motion)
        return replace(self, motions=self.motions[one], dwell_times=self.dwell_times[one], notes=self.notes[one])


def read_source(
    source: Source,
    calibration: Calibration,
    limits: ImportSettings,
    settings: RecordingSettings,
    arm: Arm | None = None,
    *,
    progress: Progress = unheard,
) -> FileSamples:
    """Return what a file holds; joint angles are those of `arm`, and its tool is where it was, by no calibration.

    Raises:
        UnusableRecording: it cannot be used; the message names the row and column.
    """
    content, name = source.content, source.name
    kind = source.kind
    if not kind and not is_bag(content) and (content.startswith(MCAP_MAGIC) or name.endswith(".mcap")):
        kind = "mcap"
    if kind == "mcap":
        return _read_recording(source, limits)
    if kind in ("", "csv") and holds_samples(content):
        stated, samples = read_samples(content, name, limits)
        return FileSamples(stated.source, stated.calibration, [samples], _believed(stated, samples, name), "csv")
    tool = None if arm is None else kinematics_of(arm)
    found = read_motions(content, name, kind, source.options, limits, tool, file=source.file, progress=progress)
    marks = replace(source.marks, whole=True) if found.whole_motion else source.marks
    count = len(found.tracks)
    own = {each.motion: each for each in source.motion_marks if each.says_anything}
    if unknown := [number for number in own if not 1 <= number <= count]:
        raise UnusableRecording(f"{name}: motion {unknown[0]} is marked, of {count} that it has")
    motions = [
        samples_of(track, name, own.get(number, marks), settings) for number, track in enumerate(found.tracks, 1)
    ]
    phases = motions[0].phases if len(motions) == 1 else f"{len(motions)} motions, the first: {motions[0].phases}"
    return FileSamples(
        name,
        Calibration("identity") if found.joint_tracks else calibration,
        [motion.samples for motion in motions],
        format=kind or recognized(content, name),
        understood=(*found.understood, _extent(found.tracks[0]), phases),
        choices=found.choices,
        dwell_times=tuple(motion.dwell_times for motion in motions),
        notes=tuple(motion.notes for motion in motions),
    )


def _extent(track: Track) -> str:
    """Say how long, how often and from where to where a motion goes."""
    times = track.times
    span = float(np.ptp(times))
    rate = (len(times) - 1) / span if span else 0.0
    known = track.positions[np.isfinite(track.positions).all(axis=1)]
    begin, end = (", ".join(f"{c:.3f}" for c in known[k].tolist()) for k in (0, -1))
    return f"{len(times)} samples in {span:.2f} s ({rate:.4g} Hz), from ({begin}) to ({end}) m"


def _read_recording(source: Source, limits: ImportSettings) -> FileSamples:
    header, samples, fault = salvage_stream(io.BytesIO(source.content), limits)
    if header is None or fault or not samples:
        raise UnusableRecording(
            f"{source.name}: no whole recording of hand samples ({fault or 'there are none in it'}); a torn one that "
            "is still in its data folder can be repaired with: teachpath doctor"
        )
    facts = read_facts_stream(io.BytesIO(source.content)).get("demonstration")
    stated = _believed(decode_demonstration(facts.encode()), samples, source.name) if facts else None
    return FileSamples(header.tracker, stated.calibration if stated else header.calibration, [samples], stated)


def _believed(stated: Demonstration, samples: list[Sample], name: str) -> Demonstration:
    """Return what a file says of its demonstration, as far as it can be true of its samples."""
    count = len(samples)
    if not 0 <= stated.grasp < stated.release <= count:
        raise UnusableRecording(
            f"{name}: it says that the object was carried from sample {stated.grasp} to {stated.release}, of {count}"
        )
    begin, end = stated.trim or (stated.grasp, stated.release)
    return stated if 0 <= begin < end <= count else replace(stated, trim=None)
