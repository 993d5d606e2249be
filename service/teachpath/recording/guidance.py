"""Advice to the operator in one sentence: how far the demonstrations agree, and what to show again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from teachpath.lengths import describe_length

MIN_DEMONSTRATIONS = 3  # of a cluster
# Largest spread of a cluster over the length of its path; clusters in recordings of real arms had at most 0.11.
MAX_SPREAD_RATIO = 0.2
COUNT_WORDS = ("no", "one", "two")
ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")


@dataclass(frozen=True, slots=True)
class ClusterSummary:
    """One cluster of the demonstrations so far."""

    count: int  # of demonstrations
    spread: float  # [m] largest distance between two of them


def advise(clusters: Sequence[ClusterSummary], length: float) -> str:
    """Return the advice, or nothing before the first demonstration.

    Args:
        clusters: in their order; the page calls them ways.
        length: of a typical path [m].
    """
    total = sum(cluster.count for cluster in clusters)
    if total == 0:
        return ""
    if total == 1:
        return "one demonstration so far; show it again"
    agree = _agreement(total, len(clusters), max(cluster.spread for cluster in clusters), length)
    thin = [(index, cluster) for index, cluster in enumerate(clusters) if cluster.count < MIN_DEMONSTRATIONS]
    if not thin:
        return agree
    index, least = min(thin, key=lambda each: each[1].count)
    which = f"the {ORDINALS[index]} way has" if index < len(ORDINALS) else f"way {index + 1} has"
    who = which if len(clusters) > 1 else "there are"
    return f"{agree}; {who} only {COUNT_WORDS[least.count]}, show it again"


def _agreement(total: int, clusters: int, spread: float, length: float) -> str:
    shown = f"{total} demonstrations"
    if clusters > 1:
        shown += f" show {clusters} ways"
        if spread == 0.0:
            return shown
    if spread <= MAX_SPREAD_RATIO * length:
        return f"{shown} {'and ' if clusters > 1 else ''}agree within {describe_length(spread, up=True)}"
    some = "; some of one way" if clusters > 1 else ""
    return f"{shown}{some} are up to {describe_length(spread, up=True)} apart, discard what you did not mean"
