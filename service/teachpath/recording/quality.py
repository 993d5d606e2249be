"""How good a demonstration is: its verdict, with the numbers that explain it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from teachpath.recording.advice import USABLE_ADVICE, ending_advice, rejection_advice
from teachpath.recording.phase_statistics import PhaseStatistics
from teachpath.recording.settings import RecordingSettings
from teachpath.records import StreamStatistics, Verdict

FAULTS = {
    "lost": "lost",
    "refused": "refused",
    "untracked": "untracked",
    "outliers": "jumping",
    "out_of_workspace": "out of the workspace",
    "conflicts": "in conflict",
    "reversals": "swinging back and forth faster than a hand",
}
REPAIRS = {"duplicated": "came twice", "reordered": "came late"}
# Statistics that belong to a place within a take; those of the positions are counted in the transport phase alone.
LOCATED_FAULTS = (
    "lost",
    "refused",
    "untracked",
    "conflicts",
    "duplicated",
    "reordered",
    "longest_gap_ns",
    "clock_jumps",
)
MAX_LISTED_DWELLS = 6


@dataclass(frozen=True, slots=True)
class QualityReport:
    """The verdict on a demonstration.

    Attributes:
        reasons: why it is not clean, with figures, the gravest first.
        advice: what the operator should know and do, in one sentence; empty when it is clean.
    """

    verdict: Verdict
    reasons: tuple[str, ...] = ()
    advice: str = ""


def assess_quality(statistics: PhaseStatistics, settings: RecordingSettings) -> QualityReport:
    """Return the verdict on a demonstration.

    Only faults from grasp to release, which is what will be learned, reject it. Faults while the hand reaches or
    returns are counted and named, and make it repaired at best.
    """
    transport = _with_unlocated(statistics)
    rejections = [*_excessive_faults(statistics, transport, settings), *_unusable(transport, settings)]
    if transport.dwell_times:
        rejections.insert(0, _unsure_phases(transport.dwell_times))
    repairs = [*_repairs(transport), *_faults_elsewhere(statistics, settings)]
    if transport.repeated and not _is_slow(transport, settings):
        repairs.append(_slow_tracker(transport))
    if 0 < transport.flaps <= settings.most_flaps:
        repairs.append(_flapping(transport))
    whole = statistics.whole
    if whole.declared_rate and abs(whole.seen_rate / whole.declared_rate - 1.0) > settings.rate_tolerance:
        repairs.append(f"the rate is {whole.seen_rate:.3g} Hz, declared {whole.declared_rate:.3g} Hz")
    reasons = (*rejections, *repairs)
    if rejections:
        return QualityReport(Verdict.REJECT, reasons, rejection_advice(transport, settings))
    return QualityReport(Verdict.REPAIRED, reasons, USABLE_ADVICE) if repairs else QualityReport(Verdict.CLEAN)


def reassess_quality(
    former: QualityReport, before: PhaseStatistics, now: PhaseStatistics, settings: RecordingSettings
) -> QualityReport:
    """Return the verdict on a demonstration whose statistics have changed.

    Reasons that do not follow from the statistics, such as a torn end, are kept.

    Args:
        former: the report so far.
        before: the statistics that it was made from.
        now: the statistics as they are now.
        settings: limits of the recording.
    """
    assessed, fresh = assess_quality(before, settings), assess_quality(now, settings)
    kept = tuple(reason for reason in former.reasons if reason not in assessed.reasons)
    if not kept:
        return fresh
    rejected_otherwise = former.verdict == Verdict.REJECT and assessed.verdict != Verdict.REJECT
    advice = fresh.advice if fresh.verdict == Verdict.REJECT else ending_advice(kept[0], rejected=rejected_otherwise)
    rejected = fresh.verdict == Verdict.REJECT or rejected_otherwise
    return QualityReport(Verdict.REJECT if rejected else Verdict.REPAIRED, (*kept, *fresh.reasons), advice)


def _with_unlocated(statistics: PhaseStatistics) -> StreamStatistics:
    """Return the statistics of the transport phase, together with those of its positions."""
    return replace(statistics.whole, **{name: getattr(statistics.transport, name) for name in LOCATED_FAULTS})


def _excessive_faults(
    statistics: PhaseStatistics, transport: StreamStatistics, settings: RecordingSettings
) -> list[str]:
    limit = settings.largest_loss
    total = statistics.transport.received + statistics.transport.lost + statistics.transport.refused
    faults = sum(getattr(transport, name) for name in FAULTS)
    if faults <= limit * total:
        return []
    return [f"{faults} of {_samples(total)} are faulty, {faults / total:.1%}, limit {limit:.1%}"]


def _unusable(statistics: StreamStatistics, settings: RecordingSettings) -> list[str]:
    found = _breaks(statistics, settings, f", limit {settings.longest_gap:.2f} s")
    if statistics.level_shifts:
        times, jump = _times(statistics.level_shifts), 100 * settings.largest_jump
        found.append(f"the position leaps {times} by over {jump:.3g} cm and stays")
    if statistics.longest_freeze_ns > settings.longest_freeze * 1e9:
        found.append(f"{_freeze(statistics)}, limit {settings.longest_freeze:.2g} s")
    if statistics.flaps > settings.most_flaps:
        found.append(f"{_flapping(statistics)}, limit {settings.most_flaps}")
    if statistics.regrasp_ns:
        found.append(f"the hand closed again {statistics.regrasp_ns * 1e-9:.2f} s after it let go")
    if _is_slow(statistics, settings):
        found.append(f"{_slow_tracker(statistics)}, limit {settings.lowest_pose_rate:.3g} Hz")
    return found


def _unsure_phases(dwell_times: Sequence[float]) -> str:
    places = "one place" if len(dwell_times) == 1 else f"{len(dwell_times)} places"
    at = ", ".join(f"{seconds:.2f}" for seconds in dwell_times[:MAX_LISTED_DWELLS])
    return (
        f"not sure where the object was taken and put: the hand dwells at {places} (at {at} s); mark it: trim it, or "
        "say at the import when it was taken and put, or that all of it is the transport"
    )


def _freeze(statistics: StreamStatistics) -> str:
    seconds, at = statistics.longest_freeze_ns * 1e-9, statistics.freeze_at_ns * 1e-9
    return f"the tracker repeats one reading for {seconds:.2f} s while the hand moves, {at:.2f} s after the grasp"


def _flapping(statistics: StreamStatistics) -> str:
    at = statistics.flap_at_ns * 1e-9
    return f"the glove reads open or closed {_times(statistics.flaps)} too shortly, first {at:.2f} s after the grasp"


def _is_slow(statistics: StreamStatistics, settings: RecordingSettings) -> bool:
    return 0.0 < statistics.measured_rate < settings.lowest_pose_rate


def _slow_tracker(statistics: StreamStatistics) -> str:
    repeat = "1 reading repeats" if statistics.repeated == 1 else f"{statistics.repeated} readings repeat"
    return f"the tracker measures {statistics.measured_rate:.3g} times a second; {repeat} the one before"


def _breaks(statistics: StreamStatistics, settings: RecordingSettings, limit: str = "") -> list[str]:
    found = []
    if statistics.longest_gap_ns > settings.longest_gap * 1e9:
        found.append(f"a gap of {statistics.longest_gap_ns * 1e-9:.2f} s{limit}")
    if statistics.clock_jumps:
        found.append(f"the device's clock jumps {_times(statistics.clock_jumps)}")
    return found


def _repairs(statistics: StreamStatistics) -> list[str]:
    return [
        f"{_samples(getattr(statistics, name))} {words}"
        for name, words in (FAULTS | REPAIRS).items()
        if getattr(statistics, name)
    ]


def _faults_elsewhere(statistics: PhaseStatistics, settings: RecordingSettings) -> list[str]:
    """Name the faults of the phases that are not learned."""
    phases = {"reaching": statistics.reach, "returning": statistics.return_}
    faults = {phase: [*_breaks(each, settings), *_repairs(each)] for phase, each in phases.items()}
    return [f"while {phase}, outside what is learned: {', '.join(found)}" for phase, found in faults.items() if found]


def _samples(count: int) -> str:
    return f"{count} sample{'s' if count != 1 else ''}"


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"
