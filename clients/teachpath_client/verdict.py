"""The verdict of a check on one rule of the contract."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Verdict:
    """What a rule found: `fault` is empty where the rule is kept."""

    rule: str
    fault: str


def print_verdicts(verdicts: Iterable[Verdict]) -> bool:
    """Print every verdict as soon as it is there; return whether all rules are kept."""
    kept = True
    for verdict in verdicts:
        kept = kept and not verdict.fault
        print(f"{'FAIL' if verdict.fault else 'pass'}  {verdict.rule}", flush=True)
        if verdict.fault:
            print(f"      {verdict.fault}", flush=True)
    return kept
