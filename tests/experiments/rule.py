"""The default's own rule: who is left out of a path at which limit of z, spoilt ones and clean ones."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import PercentFormatter

from teachpath.learning.settings import LearningSettings
from tests.experiments.figures import INK, QUOTED_COLOR, sheet
from tests.experiments.scenarios import SCENARIOS
from tests.experiments.trials import Outcome

LIMITS = tuple(float(limit) for limit in np.arange(-8, -0.9, 0.25))
SHIPPED_LIMIT = -LearningSettings().outlier_limit
KEPT_COUNT = 2  # best two are kept at any limit
COLOURS = [f"C{i}" for i in range(len(SCENARIOS))]  # matplotlib's own cycle: more than there are modes and ways
LISTED_LIMITS = (-2.0, SHIPPED_LIMIT, -4.0, -6.0)


def summary(outcomes: Iterable[Outcome]) -> dict[str, Any]:
    """Return for every scenario and limit how often all spoilt ones are left out, and how often a clean one is."""
    found: dict[str, Any] = {"limits": LIMITS}
    mine = [outcome for outcome in outcomes if outcome.mode == "default"]
    for scenario in SCENARIOS:
        runs = [outcome for outcome in mine if outcome.scenario == scenario.key]
        found[scenario.key] = {
            "spoilt": [round(float(np.mean([_all_out(run.marked_z, limit) for run in runs])), 4) for limit in LIMITS],
            "clean": [
                round(float(np.mean([_out(z, limit) for run in runs for z in run.unmarked_z])), 4) for limit in LIMITS
            ],
        }
    return found


def _all_out(ranked: Sequence[tuple[int, float]], limit: float) -> bool:
    return bool(ranked) and all(_out(each, limit) for each in ranked)


def _out(ranked: tuple[int, float], limit: float) -> bool:
    rank, z = ranked
    return rank > KEPT_COUNT and z < limit


def draw(file: Path, rule: Mapping[str, Any]) -> None:
    """Draw both shares over the limit."""
    with sheet(file, 1, 2, (8.6, 3.2)) as (figure, ((spoilt, clean),)):
        handles = []
        for colour, scenario in zip(COLOURS, SCENARIOS, strict=True):
            control = scenario.key == "control"
            style = {"color": INK if control else colour, "lw": 1.8, "ls": (0, (2, 2)) if control else "-"}
            if not control:
                spoilt.plot(LIMITS, rule[scenario.key]["spoilt"], **style)
            clean.plot(LIMITS, rule[scenario.key]["clean"], **style)
            handles.append(Line2D([], [], label=scenario.title, **style))
        for axis, title in ((spoilt, "all spoilt ones are left out"), (clean, "a clean one is left out")):
            axis.axvline(SHIPPED_LIMIT, color=QUOTED_COLOR, lw=1.0)
            axis.set_title(title)
            axis.set_xlabel("limit of z")
            axis.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0))
        spoilt.set_ylim(0, 1.02)
        clean.set_ylim(0, None)
        figure.legend(handles=handles, loc="outside lower center", ncols=5, fontsize=7.5, columnspacing=1.2)


def table(rule: Mapping[str, Any]) -> str:
    """Return both shares at a few limits as a table."""
    head = "".join(f"<th>z &lt; {limit:g}<br>spoilt<th>clean" for limit in LISTED_LIMITS)
    rows = []
    for scenario in SCENARIOS:
        shares = rule[scenario.key]
        cells = []
        for limit in LISTED_LIMITS:
            at = LIMITS.index(limit)
            out = "–" if scenario.key == "control" else f"{shares['spoilt'][at]:.1%}"
            cells.append(f"<td>{out}<td>{shares['clean'][at]:.1%}")
        rows.append(f"<tr><td>{scenario.title}{''.join(cells)}")
    return (
        "<table><caption><b>Table III.</b> Left out of the path by mode default at four limits of z; "
        f"{SHIPPED_LIMIT:g} is "
        "shipped. A smooth detour stays the hardest: clean demonstrations of this generator differ by bows of some "
        "centimetres themselves. What pace and a slow drift cannot explain tells them apart, at the price of some "
        "clean ones, most of them where nobody is spoilt: the usual scatter of four others is known only roughly."
        f"</caption><tr><th class=l>Spoilt by{head}{''.join(rows)}</table>"
    )
