"""What is shown: samples, demonstrations and the tasks they belong to."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from teachpath.records.arrays import Array, Matrix, Quaternion, Vector
from teachpath.records.calibrations import Calibration
from teachpath.records.motion import ObjectPose


class Phase(StrEnum):
    """What the hand is doing within a demonstration."""

    REACH = "reach"
    GRASP = "grasp"  # the object is in the hand and stands where it stood
    TRANSPORT = "transport"
    RELEASE = "release"  # the hand opens
    RETURN = "return"

    @cached_property  # asked for every sample; it costs a microsecond to look members up
    def is_hand_closed(self) -> bool:
        """Whether the hand is closed around the object."""
        return self in (Phase.GRASP, Phase.TRANSPORT)

    @cached_property
    def has_object(self) -> bool:
        """Whether the object is in the hand, until it is certain that the hand has released it."""
        return self.is_hand_closed or self is Phase.RELEASE


class Verdict(StrEnum):
    """How good a demonstration is."""

    CLEAN = "clean"
    REPAIRED = "repaired"  # usable, with losses
    REJECT = "reject"  # kept, but not learned from


class Sample(NamedTuple):  # which is made in a fifth of the time of a frozen dataclass
    """One reading of glove and tracker, checked.

    `position` [m] and `orientation` (None when not measured) are in the tracker frame; `flexions` run from 0 (open)
    to 1 (closed); `device_ns` is the device's clock, `receive_ns` ours; `joints` [rad] are those of an arm that shows
    the task, in the order of the station's arm, and empty where a hand shows it.
    """

    tracker: str
    sequence: int
    device_ns: int
    receive_ns: int
    position: Vector
    orientation: Quaternion | None
    flexions: tuple[float, ...]
    tracked: bool
    buttons: int = 0
    joints: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Task:
    """What is demonstrated: its name, its scene and the calibration of its demonstrations.

    Attributes:
        name: of the task, which is in its addresses.
        scene: name of what stands around the arm.
        calibration: name of the mapping to the world from the tracker's frame.
        created_ns: when it was made [ns since the Unix epoch].
        object_at_grasp: whether the object lies where the hand grasps, anew in each demonstration, instead of where
            the scene has it.
        archived_ns: when it was deleted [ns since the Unix epoch]; 0: it was not. All of it is kept, and can be
            brought back.
        display_name: what people call it; empty: its name.
    """

    name: str
    scene: str
    calibration: str
    created_ns: int
    object_at_grasp: bool = False
    archived_ns: int = 0
    display_name: str = ""


@dataclass(frozen=True, eq=False)
class Trajectory:
    """The object's motion in its transport phase, world frame.

    Attributes:
        times: (n,) [s], from 0, strictly increasing (device clock).
        positions: (n, 3) [m].
        orientations: (n, 4) unit quaternions, or None when not measured.
    """

    times: Array
    positions: Matrix
    orientations: Matrix | None = None

    def __len__(self) -> int:
        return len(self.times)

    def rounded(self, decimals: int) -> Trajectory:
        """Return the trajectory with so many digits after the point, for those who draw it."""
        turned = None if self.orientations is None else self.orientations.round(decimals)
        return Trajectory(self.times.round(decimals), self.positions.round(decimals), turned)

    def thinned(self, most: int) -> Trajectory:
        """Return at most `most` (2 or more) of its samples, evenly picked, the first and the last among them."""
        if len(self) <= most:
            return self
        kept = np.linspace(0, len(self) - 1, most).round().astype(int)
        turned = None if self.orientations is None else self.orientations[kept]
        return Trajectory(self.times[kept], self.positions[kept], turned)


@dataclass(frozen=True, slots=True)
class Clock:
    """The clock of a device against the host's.

    Attributes:
        offset_ns: host clock minus device clock at the newest sample [ns]. It includes the minimum one-way transit
            time, which cannot be observed without a round trip.
        uncertainty_ns: median transit time minus the minimum [ns].
        rate: seconds of the device's clock in one second of the host's.
    """

    offset_ns: int
    uncertainty_ns: int
    rate: float


@dataclass(frozen=True, slots=True)
class StreamStatistics:
    """Counts of the samples of one recording or demonstration.

    All from `outliers` to `measured_rate` are of the transport phase only. Numbers that were sent are received, less
    the duplicated and conflicting, or lost, or refused.

    Attributes:
        received: samples that came.
        lost: numbers that never came.
        duplicated: samples that came again.
        reordered: came after newer ones, and were put in their place.
        late: came after the demonstration they belong to was cut, which is made without them.
        refused: samples that could not be used.
        refused_numbers: first and last of the refused numbers in a row, where they can be read.
        untracked: samples in which the tracker did not see the hand.
        gaps: stretches of numbers that never came.
        missing: first and last number of each of them, of the first 20.
        longest_gap_ns: longest time without a sample, device clock [ns].
        outliers: positions that their neighbours contradict; left out of the trajectory.
        level_shifts: places where the position jumps and stays.
        out_of_workspace: positions where no hand can be.
        reversals: samples between which no hand could swing back and forth.
        repeated: readings that repeat the one before while the hand moves; left out of the trajectory.
        longest_freeze_ns: longest time for which one of them stood, device clock [ns].
        freeze_at_ns: when that began, since the grasp [ns].
        measured_rate: readings a second that differ [Hz], where some repeat; 0: none does.
        conflicts: came with a number that was taken, or that their device time contradicts.
        flaps: times for which the glove read open or closed too shortly for a hand, from the grasp on.
        flap_at_ns: when the first of them was, since the grasp [ns].
        regrasp_ns: how long the hand was open when it had let go, if it closed again at once [ns]; 0: it did not.
        clock_jumps: times that the device's clock jumped.
        declared_rate: samples a second that the client declared [Hz]; 0: it said none.
        seen_rate: numbers a second of the device's clock [Hz].
        clock: of the device against the host's; None: not known.
        notes: what an operator should know, in words.
        dwell_times: where a hand without a glove dwells, if taking and putting are not sure [s].
        joints: how many joints the arm has that showed it; 0: a hand did.
    """

    received: int = 0
    lost: int = 0
    duplicated: int = 0
    reordered: int = 0
    late: int = 0
    refused: int = 0
    refused_numbers: tuple[tuple[int, int], ...] = ()
    untracked: int = 0
    gaps: int = 0
    missing: tuple[tuple[int, int], ...] = ()
    longest_gap_ns: int = 0
    outliers: int = 0
    level_shifts: int = 0
    out_of_workspace: int = 0
    reversals: int = 0
    repeated: int = 0
    longest_freeze_ns: int = 0
    freeze_at_ns: int = 0
    measured_rate: float = 0.0
    conflicts: int = 0
    flaps: int = 0
    flap_at_ns: int = 0
    regrasp_ns: int = 0
    clock_jumps: int = 0
    declared_rate: float = 0.0
    seen_rate: float = 0.0
    clock: Clock | None = None
    notes: tuple[str, ...] = ()
    dwell_times: tuple[float, ...] = ()
    joints: int = 0


@dataclass(frozen=True, slots=True)
class RecordingDigest:
    """What a recording's file is known by.

    Attributes:
        sha256: of the whole file, hexadecimal.
        size: of the file [bytes].
        samples: their count, each as often as it came.
        first: lowest number of a sample; 0 where there is none.
        last: highest number of a sample; 0 where there is none.
    """

    sha256: str
    size: int
    samples: int
    first: int
    last: int


@dataclass(frozen=True, slots=True)
class Demonstration:
    """One trial, as a row: the samples are in its recording file.

    The transport phase is samples[grasp:release] of the recording, or samples[trim[0]:trim[1]] when the operator has
    trimmed it.

    Attributes:
        id: of the demonstration.
        task: name of its task.
        number: 1, 2, ... within its task.
        source: name of the tracker or the file.
        calibration: under which it was recorded.
        created_ns: when it was made [ns since the Unix epoch].
        duration: of the transport phase [s].
        samples: in its recording.
        grasp: index of the first sample of the transport phase, by the recorder's own cut.
        release: index behind its last sample.
        verdict: clean, repaired (usable, with losses) or reject (not learned from).
        statistics: counts of its samples.
        recording: place of the MCAP file within the recordings, or its address in object storage (`s3://...`).
        reasons: why the verdict is not clean, with figures.
        advice: what the operator should know and do about it, in one sentence.
        left_out: numbers of the samples that jumped.
        trim: begin and end (excluded) of the transport phase by the operator's cut, as indices of samples; None: the
            recorder's holds.
        mark: the operator's own: good, bad or empty for none.
        discarded_ns: when it was discarded [ns since the Unix epoch]; 0: it is not.
        amended_by: who marked, trimmed, discarded or restored it last, where the station asks.
        digest: of its recording; None: it was stored before digests were.
        object_pose: of the object before it was grasped; None: as the scene has it.
        source_sha256: of the file that it was imported from, hexadecimal; empty: it was not imported.
        station: that it was made at; empty where a station has no name.
    """

    id: str
    task: str
    number: int
    source: str
    calibration: Calibration
    created_ns: int
    duration: float
    samples: int
    grasp: int
    release: int
    verdict: Verdict
    statistics: StreamStatistics
    recording: str
    reasons: tuple[str, ...] = ()
    advice: str = ""
    left_out: tuple[int, ...] = ()
    trim: tuple[int, int] | None = None
    mark: Literal["", "good", "bad"] = ""
    discarded_ns: int = 0
    amended_by: str = ""
    digest: RecordingDigest | None = None
    object_pose: ObjectPose | None = None
    source_sha256: str = ""
    station: str = ""

    @property
    def transport(self) -> tuple[int, int]:
        """Where the transport phase begins and ends, as indices into the samples."""
        return self.trim or (self.grasp, self.release)

    @property
    def is_usable(self) -> bool:
        """Whether it is learned from: not rejected, not discarded and not marked bad."""
        return self.verdict != Verdict.REJECT and self.mark != "bad" and not self.discarded_ns
