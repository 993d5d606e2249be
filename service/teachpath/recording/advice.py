"""What an operator should know of a verdict, in one sentence for people: what happened, and what to do."""

from __future__ import annotations

from teachpath.recording.settings import RecordingSettings
from teachpath.records import StreamStatistics

RETAKE = "show it again"
# By the fault that most samples of the transport phase have: what happened, and what to do.
FAULT_ADVICE = {
    "lost": ("many readings were lost on the way", f"{RETAKE}, with a better cable or a quieter network"),
    "refused": (
        "the tracker sent readings that cannot be",
        f"check it with teachpath-client tracker-check, then {RETAKE}",
    ),
    "untracked": ("the tracker lost sight of the hand while you carried", f"{RETAKE}, nearer to its base"),
    "outliers": (
        "the position jumped while you carried",
        f"{RETAKE}, away from metal and nearer to the tracker's base",
    ),
    "out_of_workspace": (
        "you carried outside the workspace",
        f"{RETAKE} inside, or measure the calibration anew",
    ),
    "conflicts": ("two trackers send under one name", f"end one or rename it, then {RETAKE}"),
    "reversals": (
        "the position swung faster than a hand can",
        f"look for a second tracker under this name or metal near the base, then {RETAKE}",
    ),
}
USABLE_ADVICE = "usable; nothing needs to be done"
UNSURE_PHASES = (
    "it is not sure where the object was taken and put: trim it, or import it again with both moments marked"
)


def rejection_advice(statistics: StreamStatistics, settings: RecordingSettings) -> str:
    """Say what happened in the transport phase of a rejected demonstration and what to do, the gravest fault first.

    Args:
        statistics: of the transport phase, together with those of its positions.
        settings: limits of the recording.
    """
    if statistics.dwell_times:
        return UNSURE_PHASES
    seconds = statistics.longest_freeze_ns * 1e-9
    if seconds > settings.longest_freeze:
        return f"the tracker froze for {seconds:.1f} s while you carried: {RETAKE}, nearer to its base"
    if statistics.conflicts:
        return _sentence("conflicts")
    if statistics.level_shifts:
        return (
            f"the position leapt while you carried, and stayed there: {RETAKE}; "
            "do not move the tracker's base meanwhile"
        )
    if 0.0 < statistics.measured_rate < settings.lowest_pose_rate:
        rate = f"{statistics.measured_rate:.0f} times a second"
        return f"the tracker measures only {rate}: set it to {settings.lowest_pose_rate:g} or more, then {RETAKE}"
    if statistics.flaps > settings.most_flaps or statistics.regrasp_ns:
        return f"the glove flapped, so that nobody knows where you let go: calibrate the glove, then {RETAKE}"
    if statistics.clock_jumps:
        return f"the tracker's clock was set while you carried: {RETAKE}"
    gap = statistics.longest_gap_ns * 1e-9
    if gap > settings.longest_gap:
        return f"nothing came from the tracker for {gap:.1f} s while you carried: {RETAKE}, nearer to its base"
    return _sentence(max(FAULT_ADVICE, key=lambda fault: int(getattr(statistics, fault))))


def ending_advice(fault: str, *, rejected: bool) -> str:
    """Say what to do about a take that ended too early because of `fault`."""
    return f"{fault}: {RETAKE}" if rejected else f"{fault}, after you had let go: {USABLE_ADVICE}"


def _sentence(fault: str) -> str:
    happened, remedy = FAULT_ADVICE[fault]
    return f"{happened}: {remedy}"
