"""What faults of a tracker's stream become on the three routes to a demonstration: live, imported and repaired."""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterable
from html import escape
from typing import Any

import numpy as np

from teachpath.learning.evaluation import Rate
from teachpath.records import StreamStatistics
from tests.faults.faults import FAULTS
from tests.faults.routes import ROUTES, run, run_all
from tests.faults.streams import Stream, any_hand, shown

NO_FAULT = "none"
VERDICTS = ("clean", "repaired", "reject", "none")
MAX_FALSE_ALARM = 0.01  # share of faultless streams that may be not clean
COUNTER_FIELDS = ("received", "lost", "refused", "duplicated", "conflicts", "untracked")
BY_KEY = {fault.key: fault for fault in FAULTS}
CASES = [(fault.key, strength) for fault in FAULTS for strength in fault.strengths]
BATCH = 20  # faultless streams that one station records


def fault_once(key: str, strength: float, seed: int) -> dict[str, Any]:
    """Return the verdict on each route, whether the counts were right live, and whether anything is learned from."""
    random = np.random.default_rng([seed, 11])
    stream = BY_KEY[key].change(shown(random), random, strength)
    outcomes = {route: run(stream, route) for route in ROUTES}
    statistics = outcomes["live"].statistics
    assert statistics is not None
    return {
        "verdicts": {route: outcome.verdict for route, outcome in outcomes.items()},
        "exact": counted(statistics) == expected(stream),
        "learned": any(row.is_usable for outcome in outcomes.values() for row in outcome.rows),
    }


def faultless_batch(batch: int) -> dict[str, Any]:
    """Return the verdicts on each route of faultless streams, of hands and trackers of all kinds, and their number."""
    randoms = [np.random.default_rng([batch, k, 12]) for k in range(BATCH)]
    streams = [shown(random, any_hand(random)) for random in randoms]
    verdicts = {route: Counter(str(row.verdict) for row in run_all(streams, route).rows) for route in ROUTES}
    return {"n": BATCH, "verdicts": verdicts}


def counted(statistics: StreamStatistics) -> dict[str, int]:
    """Return what a recorder has counted."""
    found = {name: getattr(statistics, name) for name in COUNTER_FIELDS}
    return found | {"misplaced": statistics.reordered + statistics.late}


def expected(stream: Stream) -> dict[str, int]:
    """Return what it has to count."""
    return {name: stream.truth().get(name, 0) for name in (*COUNTER_FIELDS, "misplaced")}


def summary(
    outcomes: Iterable[tuple[tuple[str, float, int], dict[str, Any]]], faultless: Iterable[dict[str, Any]]
) -> list[dict[str, Any]]:
    """Return for every fault and strength how often which verdict was given, and how often all was counted right.

    Args:
        outcomes: of `fault_once`, with its arguments.
        faultless: of `faultless_batch`.
    """
    several, rows = list(outcomes), [_faultless_row(list(faultless))]
    for key, strength in CASES:
        runs = [found for (name, value, _), found in several if (name, value) == (key, strength)]
        verdicts = {route: Counter(found["verdicts"][route] for found in runs) for route in ROUTES}
        exact = BY_KEY[key].exact
        rows.append(
            {
                "fault": key,
                "strength": strength,
                "n": len(runs),
                "verdicts": {route: {word: counts[word] for word in VERDICTS} for route, counts in verdicts.items()},
                "exact": sum(found["exact"] for found in runs) if exact else None,
                "learned": sum(found["learned"] for found in runs),
            }
        )
    return rows


def _faultless_row(batches: list[dict[str, Any]]) -> dict[str, Any]:
    n = sum(batch["n"] for batch in batches)
    verdicts = {
        route: {word: sum(b["verdicts"][route][word] for b in batches) for word in VERDICTS} for route in ROUTES
    }
    for words in verdicts.values():
        words["none"] = n - sum(words.values())
    learned = min(words["clean"] + words["repaired"] for words in verdicts.values())
    return {"fault": NO_FAULT, "strength": 0.0, "n": n, "verdicts": verdicts, "exact": None, "learned": learned}


def targets(rows: list[dict[str, Any]]) -> list[tuple[str, str, str, bool]]:
    """Return what is asked of the recorder: what, how much, what was measured, whether it is kept."""
    found = []
    for row in rows:
        clean, n = max(of["clean"] for of in row["verdicts"].values()), row["n"]
        if row["fault"] == NO_FAULT:
            not_clean = n - min(of["clean"] for of in row["verdicts"].values())
            rate = Rate(not_clean, n)
            kept = rate.interval[1] <= MAX_FALSE_ALARM
            found.append(("faultless streams not clean", f"≤ {MAX_FALSE_ALARM:.0%} (95 %)", str(rate), kept))
        elif abs(row["strength"]) > BY_KEY[row["fault"]].limit:
            found.append((f"clean in spite of {_named(row)}", "0", f"{clean} of {n}", clean == 0))
        if row["exact"] is not None:
            found.append(
                (f"all samples counted right: {_named(row)}", "all", f"{row['exact']} of {n}", row["exact"] == n)
            )
    return found


def section(rows: list[dict[str, Any]]) -> list[str]:
    """Return the part of the report."""
    head = "".join(f"<th>{route}: {', '.join(VERDICTS)}" for route in ROUTES)
    body = []
    for row in rows:
        cells = "".join("<td>" + ", ".join(str(row["verdicts"][r][word]) for word in VERDICTS) for r in ROUTES)
        exact = "–" if row["exact"] is None else f"{row['exact']}"
        body.append(f"<tr><td class=l>{escape(_named(row))}{cells}<td>{exact}<td>{row['learned']}<td>{row['n']}")
    missed = [what for what, _, _, kept in targets(rows) if not kept]
    ends = "Every target was kept." if not missed else f"Falls short: {escape('; '.join(missed))}."
    return [
        "<h2>Faults of a tracker</h2>",
        "<p>A hand shows a task with a glove and a tracker of 50 Hz and 0.3 mm of noise; then one fault befalls the "
        "stream, a freeze only where the hand carries fast. No fault stronger than its limit may be clean. Of "
        "faultless streams, carried for 1 to 5 s with 0.1 to 1 mm of noise, the 95 % interval of what is not clean "
        f"must end under {MAX_FALSE_ALARM:.0%}. {ends}</p>",
        "<table><caption><b>Table VIII.</b> Verdicts on each route, whether every sample was counted as what it was, "
        f"and from how many streams anything is learned.</caption><tr><th class=l>Fault{head}<th>counts right"
        f"<th>learned<th>of{''.join(body)}</table>",
    ]


def _named(row: dict[str, Any]) -> str:
    if row["fault"] == NO_FAULT:
        return "nothing"
    return f"{row['fault']} {row['strength']:g} {BY_KEY[row['fault']].unit}"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Count how many faultless streams are not clean on each route.")
    parser.add_argument("--batches", type=int, default=25, help=f"of {BATCH} streams")
    row = _faultless_row([faultless_batch(batch) for batch in range(parser.parse_args().batches)])
    for route, words in row["verdicts"].items():
        sys.stdout.write(f"{route}: {words}, not clean {Rate(row['n'] - words['clean'], row['n'])}\n")
