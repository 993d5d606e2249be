"""The verdict on a demonstration: clean, repaired or reject, with the numbers that say why."""

from __future__ import annotations

from dataclasses import dataclass

from teachpath.recording.settings import RecordingSettings
from teachpath.records import Account

FAULTS = {
    "lost": "lost",
    "refused": "refused",
    "untracked": "untracked",
    "jumps": "jumping",
    "out_of_workspace": "out of the workspace",
    "conflicts": "in conflict",
}
REPAIRS = {"duplicated": "came twice", "reordered": "came late"}


@dataclass(frozen=True, slots=True)
class Verdict:
    """What is thought of a demonstration: clean, repaired (usable, with losses) or reject, and why."""

    word: str
    reasons: tuple[str, ...] = ()


def judge(account: Account, settings: RecordingSettings) -> Verdict:
    """Return the verdict on a demonstration, its gravest reasons first."""
    rejections = [*_too_many(account, settings), *_unusable(account, settings)]
    repairs = [
        f"{_samples(getattr(account, name))} {words}"
        for name, words in (FAULTS | REPAIRS).items()
        if getattr(account, name)
    ]
    if account.declared_rate and abs(account.seen_rate / account.declared_rate - 1.0) > settings.rate_tolerance:
        repairs.append(f"the rate is {account.seen_rate:.3g} Hz, declared {account.declared_rate:.3g} Hz")
    word = "reject" if rejections else "repaired" if repairs else "clean"
    return Verdict(word, (*rejections, *repairs))


def judge_again(former: Verdict, before: Account, now: Account, settings: RecordingSettings) -> Verdict:
    """Return the verdict on a changed account; what was said for other reasons (a torn end) is said again.

    Args:
        former: the verdict so far.
        before: the account that it was on.
        now: the account as it is.
        settings: limits of the recording.
    """
    judged, fresh = judge(before, settings), judge(now, settings)
    kept = tuple(reason for reason in former.reasons if reason not in judged.reasons)
    if not kept:
        return fresh
    rejected = fresh.word == "reject" or (former.word == "reject" and judged.word != "reject")
    return Verdict("reject" if rejected else "repaired", (*kept, *fresh.reasons))


def _too_many(account: Account, settings: RecordingSettings) -> list[str]:
    total = account.received + account.lost
    faults = sum(getattr(account, name) for name in FAULTS)
    if faults <= settings.largest_loss * total:
        return []
    return [f"{faults} of {_samples(total)} are faulty, {faults / total:.1%}, limit {settings.largest_loss:.1%}"]


def _unusable(account: Account, settings: RecordingSettings) -> list[str]:
    found = []
    if account.longest_gap_ns > settings.longest_gap * 1e9:
        found.append(f"a gap of {account.longest_gap_ns * 1e-9:.2f} s, limit {settings.longest_gap:.2f} s")
    if account.clock_jumps:
        found.append(f"the device's clock jumps {_times(account.clock_jumps)}")
    if account.leaps:
        found.append(
            f"the position leaps {_times(account.leaps)} by over {100 * settings.largest_jump:.3g} cm and stays"
        )
    return found


def _samples(count: int) -> str:
    return f"{count} sample{'s' if count != 1 else ''}"


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"
