"""The verdict on a demonstration: clean, repaired or reject, with the numbers that say why."""

from __future__ import annotations

from dataclasses import dataclass, replace

from teachpath.recording.phase_statistics import PhaseStatistics
from teachpath.recording.settings import RecordingSettings
from teachpath.records import StreamStatistics

FAULTS = {
    "lost": "lost",
    "refused": "refused",
    "untracked": "untracked",
    "jumps": "jumping",
    "out_of_workspace": "out of the workspace",
    "conflicts": "in conflict",
}
REPAIRS = {"duplicated": "came twice", "reordered": "came late"}
# What has a place within a take; refused payloads have none, and the positions are judged of what is learned alone.
PLACED = ("lost", "untracked", "conflicts", "duplicated", "reordered", "longest_gap_ns", "clock_jumps")


@dataclass(frozen=True, slots=True)
class Verdict:
    """What is thought of a demonstration: clean, repaired (usable, with losses) or reject, and why."""

    word: str
    reasons: tuple[str, ...] = ()


def judge(parts: PhaseStatistics, settings: RecordingSettings) -> Verdict:
    """Return the verdict on a demonstration, its gravest reasons first.

    What is learned decides whether it is rejected: the samples from grasp to release. What happened while the hand
    reached or returned is counted and said, and leaves it no better than repaired.
    """
    learned = _learned(parts)
    rejections = [*_too_many(parts, learned, settings), *_unusable(learned, settings)]
    repairs = [*_repairs(learned), *_elsewhere(parts, settings)]
    whole = parts.whole
    if whole.declared_rate and abs(whole.seen_rate / whole.declared_rate - 1.0) > settings.rate_tolerance:
        repairs.append(f"the rate is {whole.seen_rate:.3g} Hz, declared {whole.declared_rate:.3g} Hz")
    word = "reject" if rejections else "repaired" if repairs else "clean"
    return Verdict(word, (*rejections, *repairs))


def judge_again(former: Verdict, before: PhaseStatistics, now: PhaseStatistics, settings: RecordingSettings) -> Verdict:
    """Return the verdict on a changed take; what was said for other reasons (a torn end) is said again.

    Args:
        former: the verdict so far.
        before: the accounts that it was on.
        now: the accounts as they are.
        settings: limits of the recording.
    """
    judged, fresh = judge(before, settings), judge(now, settings)
    kept = tuple(reason for reason in former.reasons if reason not in judged.reasons)
    if not kept:
        return fresh
    rejected = fresh.word == "reject" or (former.word == "reject" and judged.word != "reject")
    return Verdict("reject" if rejected else "repaired", (*kept, *fresh.reasons))


def _learned(parts: PhaseStatistics) -> StreamStatistics:
    """Return the account of what is learned, with all that has no place within the take."""
    return replace(parts.whole, **{name: getattr(parts.transport, name) for name in PLACED})


def _too_many(parts: PhaseStatistics, learned: StreamStatistics, settings: RecordingSettings) -> list[str]:
    limit, found = settings.largest_loss, []
    total = parts.transport.received + parts.transport.lost
    faults = sum(getattr(learned, name) for name in FAULTS if name != "refused")
    if faults > limit * total:
        found.append(f"{faults} of {_samples(total)} are faulty, {faults / total:.1%}, limit {limit:.1%}")
    refused, came = parts.whole.refused, parts.whole.received + parts.whole.refused
    if refused > limit * came:
        found.append(f"{refused} of {_samples(came)} were refused, {refused / came:.1%}, limit {limit:.1%}")
    return found


def _unusable(account: StreamStatistics, settings: RecordingSettings) -> list[str]:
    found = _breaks(account, settings, f", limit {settings.longest_gap:.2f} s")
    if account.leaps:
        found.append(
            f"the position leaps {_times(account.leaps)} by over {100 * settings.largest_jump:.3g} cm and stays"
        )
    return found


def _breaks(account: StreamStatistics, settings: RecordingSettings, limit: str = "") -> list[str]:
    found = []
    if account.longest_gap_ns > settings.longest_gap * 1e9:
        found.append(f"a gap of {account.longest_gap_ns * 1e-9:.2f} s{limit}")
    if account.clock_jumps:
        found.append(f"the device's clock jumps {_times(account.clock_jumps)}")
    return found


def _repairs(account: StreamStatistics) -> list[str]:
    return [
        f"{_samples(getattr(account, name))} {words}"
        for name, words in (FAULTS | REPAIRS).items()
        if getattr(account, name)
    ]


def _elsewhere(parts: PhaseStatistics, settings: RecordingSettings) -> list[str]:
    """Say what happened where nothing is learned."""
    ways = {"reaching": parts.reach, "returning": parts.return_}
    said = {way: [*_breaks(account, settings), *_repairs(account)] for way, account in ways.items()}
    return [f"while {way}, outside what is learned: {', '.join(faults)}" for way, faults in said.items() if faults]


def _samples(count: int) -> str:
    return f"{count} sample{'s' if count != 1 else ''}"


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"
