"""The motion of a file as the samples of a live hand: numbered, with its phases on the grasp button."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from teachpath.errors import UnusableRecording
from teachpath.io.readers.contract import Track
from teachpath.recording.clock_numbers import number_by_clock, without_stride
from teachpath.recording.motion_phases import PhaseEvidence, find_motion_phases
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Array, Quaternion, Sample, Vector
from teachpath_proto.sample_rules import GRASP_BUTTON

EPOCH_NS = 10**17  # stamps over it (1973) count from the Unix epoch
Booleans = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class PhaseMarks:
    """What the user says of the phases of a motion.

    Attributes:
        grasp: [s] from the beginning of the file, at which the object is taken; None: not said.
        release: [s] likewise, at which it is put; None: not said.
        whole: the motion is the transport alone.
    """

    grasp: float | None = None
    release: float | None = None
    whole: bool = False

    @property
    def says_anything(self) -> bool:
        """Whether anything is said."""
        return self.whole or self.grasp is not None or self.release is not None

    def where(self, name: str) -> str:
        """Return the place in a file that it is about."""
        return name


@dataclass(frozen=True, slots=True)
class MotionMarks(PhaseMarks):
    """What the user says of the phases of one motion of several.

    Attributes:
        motion: its number in the file, from 1.
    """

    motion: int = 1

    def where(self, name: str) -> str:
        """Return the place in a file that it is about."""
        return f"{name}, motion {self.motion}"


@dataclass(frozen=True, slots=True)
class TrackSamples:
    """A motion as samples.

    Attributes:
        samples: in the order of the file.
        phases: how taking and putting are known, as a phrase.
        dwell_times: [s] where the hand dwells, if it is not sure which of these dwells are taking and putting.
        notes: sentences about the file's clock, for the operator.
    """

    samples: list[Sample]
    phases: str
    dwell_times: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()


def samples_of(track: Track, name: str, marks: PhaseMarks, settings: RecordingSettings) -> TrackSamples:
    """Return the samples of a motion.

    Its phases come from marks, else from its columns of flexions or grasp, else from the motion itself.

    Args:
        track: as it was read.
        name: of the file, for the samples and for errors.
        marks: what the user says of the phases.
        settings: of recording; when a hand counts as closed.

    Raises:
        UnusableRecording: marks outside the motion.
    """
    tracked = np.ones(len(track.positions), np.bool_) if track.tracked is None else track.tracked
    known = _last_known(tracked)
    positions = track.positions[known]
    closed, phases, dwell_times = _closed(track, tracked, positions, name, marks, settings)
    numbers = number_by_clock(track.stamps_ns, positions) if track.numbers is None else without_stride(track.numbers)
    begin = int(track.stamps_ns.min())
    now = time.time_ns()
    shift = 0 if begin > EPOCH_NS else now - begin
    flexions = track.flexions if track.flexions is not None and not marks.says_anything else None
    samples = []
    for k, stamp in enumerate(track.stamps_ns.tolist()):
        x, y, z = positions[k].tolist()
        orientation: Quaternion | None = None
        if track.orientations is not None:
            w, i, j, k_ = track.orientations[known[k]].tolist()
            orientation = (w, i, j, k_)
        position: Vector = (x, y, z)
        bent = () if flexions is None else tuple(np.nan_to_num(flexions[k]).tolist())
        button = GRASP_BUTTON if closed[k] else 0
        joints = () if track.joints is None else tuple(track.joints[k].tolist())
        samples.append(
            Sample(
                name,
                int(numbers[k]),
                stamp + shift,
                now + stamp - begin,
                position,
                orientation,
                bent,
                bool(tracked[k]),
                button,
                joints,
            )
        )
    return TrackSamples(samples, phases, dwell_times, _notes(track))


def _notes(track: Track) -> tuple[str, ...]:
    steps = np.diff(track.stamps_ns)
    equal, back = int(np.count_nonzero(steps == 0)), int(np.count_nonzero(steps < 0))
    found = []
    if equal:
        found.append(f"{equal} rows have the time of the row before; of each such time the first one counts")
    if back:
        found.append(f"time goes back at {back} rows; each belongs where its time puts it")
    return tuple(found)


def _last_known(tracked: Booleans) -> NDArray[np.intp]:
    """Return for each reading the index of the last tracked one, or of the first one."""
    last = np.maximum.accumulate(np.where(tracked, np.arange(len(tracked)), -1))
    return np.where(last < 0, np.argmax(tracked), last)


def _closed(
    track: Track, tracked: Booleans, positions: Array, name: str, marks: PhaseMarks, settings: RecordingSettings
) -> tuple[Booleans, str, tuple[float, ...]]:
    """Return where the hand is closed (n,) by its grasp button, how it is known, and the dwells that leave it open."""
    count = len(positions)
    times = (track.stamps_ns - track.stamps_ns.min()) * 1e-9
    if marks.whole:
        return np.ones(count, np.bool_), "all of it is the transport, as said", ()
    if marks.says_anything:
        return *_marked(times, name, marks), ()
    if track.flexions is not None:
        return np.zeros(count, np.bool_), "phases from the flexions", ()
    if track.closure is not None:
        return _hysteresis(track.closure, settings), "phases from the grasp column", ()
    order = np.argsort(track.stamps_ns, kind="stable")
    order = order[tracked[order]]
    found = find_motion_phases(times[order], positions[order])
    if found.evidence is PhaseEvidence.DWELLS:
        taken, put = times[order[found.grasp]], times[order[found.release - 1]]
        words = f"taken at {taken:.2f} s and put at {put:.2f} s, where the hand dwells"
        return (times >= taken) & (times <= put), words, ()
    unsure = found.dwell_times if found.evidence is PhaseEvidence.UNSURE else ()
    words = (
        "not sure where the object was taken and put"
        if unsure
        else "all of it is the transport: the hand dwells nowhere"
    )
    return np.ones(count, np.bool_), words, unsure


def _marked(times: Array, name: str, marks: PhaseMarks) -> tuple[Booleans, str]:
    last = float(times.max())
    grasp = 0.0 if marks.grasp is None else marks.grasp
    release = last if marks.release is None else marks.release
    if not 0.0 <= grasp < release <= last + 1e-9:
        raise UnusableRecording(
            f"{marks.where(name)}: the marks {grasp:g} and {release:g} s must rise and lie in the motion, 0 to "
            f"{last:.3f} s from its start"
        )
    return (times >= grasp) & (times <= release), f"taken at {grasp:g} s and put at {release:g} s, as marked"


def _hysteresis(closure: Array, settings: RecordingSettings) -> Booleans:
    """Return where the hand is closed: from over `close_at` until it is under `open_at`; blank cells change nothing."""
    closed, found = False, np.zeros(len(closure), np.bool_)
    for k, value in enumerate(closure.tolist()):
        if value == value:  # not NaN
            closed = value > (settings.open_at if closed else settings.close_at)
        found[k] = closed
    return found
