"""How a take becomes a demonstration: assess its quality, finish its file, make its row."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from teachpath.errors import UnusableRecording
from teachpath.io.store.recording_facts import facts_of
from teachpath.io.store.recordings import RecordingFile, Recordings
from teachpath.recording.advice import ending_advice
from teachpath.recording.demonstration import carried_numbers, object_trajectory, place_of, to_world, usable_samples
from teachpath.recording.grip_flaps import find_grip_flaps
from teachpath.recording.phase_statistics import PhaseStatistics, phase_statistics, tell_arrivals
from teachpath.recording.phases import TransportSpan
from teachpath.recording.position_outliers import find_outliers
from teachpath.recording.posture import joint_count
from teachpath.recording.quality import QualityReport, assess_quality, reassess_quality
from teachpath.recording.repeated_readings import find_repeated_readings
from teachpath.recording.settings import RecordingSettings
from teachpath.records import (
    Calibration,
    Demonstration,
    ObjectPose,
    Sample,
    SampleColumns,
    StreamStatistics,
    Trajectory,
    Vector,
    Verdict,
)


@dataclass(frozen=True, eq=False)
class SegmentedTake:
    """A take whose transport phase is known.

    Attributes:
        samples: in the order received.
        cut: its transport phase.
        statistics: of its samples, without the outliers of their positions.
        calibration: of its tracker.
        carried: start of the object's centre [m, world], or None.
        object_pose: of the object before it was grasped; None = where the scene has it.
        fault: why the take ended too early, or empty.
    """

    samples: Sequence[Sample]
    cut: TransportSpan
    statistics: StreamStatistics
    calibration: Calibration
    carried: Vector | None
    object_pose: ObjectPose | None = None
    fault: str = ""


def complete_take(
    recordings: Recordings,
    settings: RecordingSettings,
    file: RecordingFile,
    take: SegmentedTake,
    identity: Mapping[str, str],
) -> tuple[Demonstration, Trajectory]:
    """Finish the file of a take, and return its demonstration, which is still to be stored.

    Args:
        identity: id, task and source of the demonstration.

    Raises:
        UnusableRecording: the transport phase is too short; nothing was finished.
        OSError: the file cannot be finished.
    """
    take, cut = replace(take, samples=SampleColumns.of(take.samples)), take.cut
    if cut.release - cut.grasp < settings.shortest_transport:
        raise UnusableRecording(
            f"a transport phase of {cut.release - cut.grasp} samples is under the least of "
            f"{settings.shortest_transport}: the object was let go at once"
        )
    statistics, left_out = add_content_faults(take, settings)
    trajectory = object_trajectory(take.samples, cut, take.calibration, take.carried, left_out=left_out)
    quality = _assess(phase_statistics(take.samples, cut, statistics, settings), take, settings)
    demonstration = Demonstration(
        id=identity["id"],
        task=identity["task"],
        number=0,
        source=identity["source"],
        calibration=take.calibration,
        created_ns=time.time_ns(),
        duration=float(trajectory.times[-1]),
        samples=len(take.samples),
        grasp=cut.grasp,
        release=cut.release,
        verdict=quality.verdict,
        statistics=statistics,
        recording="",
        reasons=quality.reasons,
        advice=quality.advice,
        left_out=left_out,
        object_pose=take.object_pose,
    )
    finished = file.finish(facts_of(demonstration))
    return replace(demonstration, recording=recordings.place(finished), digest=file.digest), trajectory


def add_content_faults(take: SegmentedTake, settings: RecordingSettings) -> tuple[StreamStatistics, tuple[int, ...]]:
    """Return the statistics of a take with the faults of what it shows, and the numbers of samples to leave out.

    Left out are positions that jump, readings that repeat the one before, and samples of another source.
    """
    ordered, foreign = _own_samples(take, settings)
    grasp, after = carried_numbers(take.samples, take.cut)
    span = place_of(ordered, grasp), place_of(ordered, after)
    if span[0] == span[1]:
        return take.statistics, tuple(sorted(foreign))
    carried = ordered[span[0] : span[1]]
    repeated = find_repeated_readings(ordered, *span)
    stale = np.array(repeated.indices, np.int64)
    # Without them, the reading after one is a step over the time it took, and no leap.
    measured = carried.select(~np.isin(np.arange(*span), stale))
    found = find_outliers(measured, to_world(take.calibration, measured.position), settings)
    flaps = find_grip_flaps(take.samples, take.cut, settings)
    statistics = replace(
        take.statistics,
        flaps=flaps.count,
        flap_at_ns=flaps.first_at_ns,
        regrasp_ns=flaps.regrasp_ns,
        outliers=len(found.outliers),
        level_shifts=found.level_shifts,
        out_of_workspace=found.out_of_workspace,
        reversals=found.reversals,
        repeated=len(repeated.indices),
        longest_freeze_ns=round(1e9 * repeated.longest),
        freeze_at_ns=int(ordered.device_ns[repeated.longest_at] - carried.device_ns[0]) if repeated.indices else 0,
        measured_rate=repeated.measured_rate,
        joints=joint_count(carried),
    )
    left_out = {*found.outliers, *ordered.sequence[stale].tolist(), *foreign}
    return statistics, tuple(sorted(left_out))


def _own_samples(take: SegmentedTake, settings: RecordingSettings) -> tuple[SampleColumns, set[int]]:
    """Return the usable samples of the take's own source in the order of their numbers, and the numbers of others."""
    columns = SampleColumns.of(take.samples)
    usable = usable_samples(columns)
    if columns.is_in_order:
        return usable, set()
    arrivals = tell_arrivals(columns, take.statistics, settings)
    own = columns.sequence[[arrival.belongs for arrival in arrivals]]
    return usable.select(np.isin(usable.sequence, own)), set(columns.sequence.tolist()) - set(own.tolist())


def reassess(
    before: Demonstration, after: Demonstration, samples: Sequence[Sample], settings: RecordingSettings
) -> dict[str, Any]:
    """Assess the quality of a demonstration whose calibration or trim has changed; return the changes of its row.

    Args:
        before: as it is stored.
        after: as it will be.
        samples: of its recording.
    """
    samples, cut = SampleColumns.of(samples), TransportSpan(*after.transport)
    take = SegmentedTake(samples, cut, before.statistics, after.calibration, None)
    statistics, left_out = add_content_faults(take, settings)
    quality = reassess_quality(
        QualityReport(before.verdict, before.reasons, before.advice),
        phase_statistics(samples, TransportSpan(*before.transport), _marked_by(before, before.statistics), settings),
        phase_statistics(samples, cut, _marked_by(after, statistics), settings),
        settings,
    )
    return {
        "statistics": statistics,
        "left_out": left_out,
        "verdict": quality.verdict,
        "reasons": quality.reasons,
        "advice": quality.advice,
    }


def _marked_by(demonstration: Demonstration, statistics: StreamStatistics) -> StreamStatistics:
    """Return the statistics without dwells that leave the phases open, if an operator has marked them by a trim."""
    return replace(statistics, dwell_times=()) if demonstration.trim else statistics


def _assess(statistics: PhaseStatistics, take: SegmentedTake, settings: RecordingSettings) -> QualityReport:
    quality = assess_quality(statistics, settings)
    if not take.fault:
        return quality
    rejected = take.cut.open_ended or quality.verdict == Verdict.REJECT
    verdict = Verdict.REJECT if rejected else Verdict.REPAIRED
    advice = quality.advice if quality.verdict == Verdict.REJECT else ending_advice(take.fault, rejected=rejected)
    return QualityReport(verdict, (take.fault, *quality.reasons), advice)
