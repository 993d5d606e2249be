"""What faults of a tracker's stream become on the three routes to a demonstration: live, imported and repaired."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from html import escape
from typing import Any

import numpy as np

from teachpath.records import StreamStatistics
from tests.experiments.trials import Rate
from tests.faults.faults import FAULTS
from tests.faults.routes import ROUTES, run
from tests.faults.streams import Stream, shown

NO_FAULT = "none"
VERDICTS = ("clean", "repaired", "reject", "none")
MAX_FALSE_ALARM = 0.01  # share of faultless streams that may be not clean
COUNTED = ("received", "lost", "refused", "duplicated", "conflicts", "untracked")
BY_KEY = {fault.key: fault for fault in FAULTS}
CASES = [(NO_FAULT, 0.0)] + [(fault.key, strength) for fault in FAULTS for strength in fault.strengths]


def fault_once(key: str, strength: float, seed: int) -> dict[str, Any]:
    """Return the verdict on each route, whether the counts were right live, and whether anything is learned from."""
    random = np.random.default_rng([seed, 11])
    stream = shown(random)
    if key != NO_FAULT:
        stream = BY_KEY[key].change(stream, random, strength)
    outcomes = {route: run(stream, route) for route in ROUTES}
    statistics = outcomes["live"].statistics
    assert statistics is not None
    return {
        "verdicts": {route: outcome.verdict for route, outcome in outcomes.items()},
        "exact": counted(statistics) == expected(stream),
        "learned": any(row.is_usable for outcome in outcomes.values() for row in outcome.rows),
    }


def counted(statistics: StreamStatistics) -> dict[str, int]:
    """Return what a recorder has counted."""
    found = {name: getattr(statistics, name) for name in COUNTED}
    return found | {"misplaced": statistics.reordered + statistics.late}


def expected(stream: Stream) -> dict[str, int]:
    """Return what it has to count."""
    return {name: stream.truth().get(name, 0) for name in (*COUNTED, "misplaced")}


def summary(outcomes: Iterable[tuple[tuple[str, float, int], dict[str, Any]]]) -> list[dict[str, Any]]:
    """Return for every fault and strength how often which verdict was given, and how often all was counted right."""
    several = list(outcomes)
    rows = []
    for key, strength in CASES:
        runs = [found for (name, value, _), found in several if (name, value) == (key, strength)]
        verdicts = {route: Counter(found["verdicts"][route] for found in runs) for route in ROUTES}
        exact = key == NO_FAULT or BY_KEY[key].exact
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


def targets(rows: list[dict[str, Any]]) -> list[tuple[str, str, str, bool]]:
    """Return what is asked of the recorder: what, how much, what was measured, whether it is kept."""
    found = []
    for row in rows:
        clean, n = max(of["clean"] for of in row["verdicts"].values()), row["n"]
        if row["fault"] == NO_FAULT:
            not_clean = n - min(of["clean"] for of in row["verdicts"].values())
            kept = not_clean <= MAX_FALSE_ALARM * n
            found.append(("faultless streams not clean", f"≤ {MAX_FALSE_ALARM:.0%}", str(Rate(not_clean, n)), kept))
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
        "stream, a freeze only where the hand carries fast. No fault stronger than its limit may be clean, and at "
        f"most {MAX_FALSE_ALARM:.0%} of the faultless may be anything else. {ends}</p>",
        "<table><caption><b>Table VIII.</b> Verdicts on each route, whether every sample was counted as what it was, "
        f"and from how many streams anything is learned.</caption><tr><th class=l>Fault{head}<th>counts right"
        f"<th>learned<th>of{''.join(body)}</table>",
    ]


def _named(row: dict[str, Any]) -> str:
    if row["fault"] == NO_FAULT:
        return "nothing"
    return f"{row['fault']} {row['strength']:g} {BY_KEY[row['fault']].unit}"
