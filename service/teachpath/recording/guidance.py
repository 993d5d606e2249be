"""The coach: one sentence that says how far the demonstrations agree, and what to show again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

ENOUGH = 3  # demonstrations of a way
APART = 0.2  # of the length of a path: those of one way were at most 0.11 from each other in recordings of real arms
COUNTS = ("no", "one", "two")
PLACES = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")


@dataclass(frozen=True, slots=True)
class ClusterSummary:
    """One way of doing the task, as shown so far."""

    count: int  # of demonstrations
    spread: float  # [m] largest distance of two of them


def advise(ways: Sequence[ClusterSummary], length: float) -> str:
    """Return the sentence for the operator, or nothing before the first demonstration.

    Args:
        ways: in their order.
        length: of a typical path [m].
    """
    total = sum(way.count for way in ways)
    if total == 0:
        return ""
    if total == 1:
        return "one demonstration so far; show it again"
    agree = _agreement(total, len(ways), max(way.spread for way in ways), length)
    thin = [(index, way) for index, way in enumerate(ways) if way.count < ENOUGH]
    if not thin:
        return agree
    index, least = min(thin, key=lambda each: each[1].count)
    which = f"the {PLACES[index]} way has" if index < len(PLACES) else f"way {index + 1} has"
    who = which if len(ways) > 1 else "there are"
    return f"{agree}; {who} only {COUNTS[least.count]}, show it again"


def _agreement(total: int, ways: int, spread: float, length: float) -> str:
    shown = f"{total} demonstrations"
    if ways > 1:
        shown += f" show {ways} ways"
        if spread == 0.0:
            return shown
    if spread <= APART * length:
        return f"{shown} {'and ' if ways > 1 else ''}agree within {100 * spread:.1f} cm"
    some = "; some of one way" if ways > 1 else ""
    return f"{shown}{some} are up to {100 * spread:.1f} cm apart, discard what you did not mean"
