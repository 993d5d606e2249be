"""How a take ends: its samples become a demonstration, judged, with its file finished and its row stored."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from teachpath.errors import UnusableRecording
from teachpath.io.store.recordings import RecordingFile, facts_of
from teachpath.io.store.store import Store
from teachpath.recording.demonstration import object_trajectory, to_world, usable_samples
from teachpath.recording.phase_statistics import PhaseStatistics, phase_statistics
from teachpath.recording.phases import TransportSpan
from teachpath.recording.position_outliers import find_outliers
from teachpath.recording.settings import RecordingSettings
from teachpath.recording.verdict import Verdict, judge, judge_again
from teachpath.records import Calibration, Demonstration, Sample, StreamStatistics, Trajectory, Vector


@dataclass(frozen=True, eq=False)
class SegmentedTake:
    """A take whose phases are known.

    Attributes:
        account: of its samples; the faults of the positions are added here.
        carried: start of the object's centre [m, world], or None.
        fault: why it ended too early, or empty.
    """

    samples: Sequence[Sample]
    cut: TransportSpan
    account: StreamStatistics
    calibration: Calibration
    carried: Vector | None
    fault: str = ""


def complete_take(
    store: Store, settings: RecordingSettings, take: RecordingFile, taken: SegmentedTake, facts: Mapping[str, str]
) -> tuple[Demonstration, Trajectory]:
    """Finish a take's file and store its demonstration; `facts` are its id, task and source.

    Raises:
        UnusableRecording: the transport phase is too short; nothing was finished or stored.
        OSError: the file cannot be finished.
    """
    cut = taken.cut
    if cut.release - cut.grasp < settings.shortest_transport:
        raise UnusableRecording(
            f"a transport phase of {cut.release - cut.grasp} samples is under the least of "
            f"{settings.shortest_transport}: the object was let go at once"
        )
    account, left_out = add_position_outliers(taken, settings)
    trajectory = object_trajectory(taken.samples, cut, taken.calibration, taken.carried, left_out=left_out)
    verdict = _judge(phase_statistics(taken.samples, cut, account, settings), taken, settings)
    demonstration = Demonstration(
        id=facts["id"],
        task=facts["task"],
        number=0,
        source=facts["source"],
        calibration=taken.calibration,
        created_ns=time.time_ns(),
        duration=float(trajectory.times[-1]),
        samples=len(taken.samples),
        grasp=cut.grasp,
        release=cut.release,
        verdict=verdict.word,
        account=account,
        recording="",
        reasons=verdict.reasons,
        left_out=left_out,
    )
    file = take.finish(facts_of(demonstration))
    stored = store.add_demonstration(replace(demonstration, recording=store.recordings.place(file)))
    return stored, trajectory


def add_position_outliers(
    taken: SegmentedTake, settings: RecordingSettings
) -> tuple[StreamStatistics, tuple[int, ...]]:
    """Return a take's account with the faults of its positions, and the numbers of the samples that jumped."""
    ordered = usable_samples(taken.samples[taken.cut.grasp : taken.cut.release])
    if not ordered:
        return taken.account, ()
    positions = to_world(taken.calibration, np.array([s.position for s in ordered]))
    faults = find_outliers(ordered, positions, settings)
    account = replace(
        taken.account, jumps=len(faults.outliers), leaps=faults.level_shifts, out_of_workspace=faults.out_of_workspace
    )
    return account, faults.outliers


def reassess(
    before: Demonstration, after: Demonstration, samples: Sequence[Sample], settings: RecordingSettings
) -> dict[str, Any]:
    """Return what is thought of a demonstration whose calibration or trim has changed, as changes of its row.

    Args:
        before: as it is stored.
        after: as it will be.
        samples: of its recording.
    """
    cut = TransportSpan(*after.transport)
    account, left_out = add_position_outliers(
        SegmentedTake(samples, cut, before.account, after.calibration, None), settings
    )
    verdict = judge_again(
        Verdict(before.verdict, before.reasons),
        phase_statistics(samples, TransportSpan(*before.transport), before.account, settings),
        phase_statistics(samples, cut, account, settings),
        settings,
    )
    return {"account": account, "left_out": left_out, "verdict": verdict.word, "reasons": verdict.reasons}


def _judge(parts: PhaseStatistics, taken: SegmentedTake, settings: RecordingSettings) -> Verdict:
    verdict = judge(parts, settings)
    if not taken.fault:
        return verdict
    reasons = (taken.fault, *verdict.reasons)
    return Verdict("reject" if taken.cut.open_ended or verdict.word == "reject" else "repaired", reasons)
