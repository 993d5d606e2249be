"""What is asked of mode default and what it reaches; and the few lines printed at the end."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.table import Table

from tests.experiments import ablation, adaptation_report, clustering, recorded_sets
from tests.experiments.results import Found, by_place, outranked, revived, right, uneven
from tests.experiments.scenarios import GROUPINGS, SCENARIOS
from tests.experiments.trials import MODES

SHAPE_BOUND = 0.01  # m, Fréchet distance asked of mode default
UNEVEN_SHARE = 0.01  # probability below which the rates at the five places count as different


def targets(found: Found) -> list[tuple[str, str, str, bool]]:
    """Return what is asked of mode default: what, how much, what was measured, whether it is kept."""
    rows = []
    rates, groups = outranked(found), right(found)
    for scenario in SCENARIOS:
        rate = rates[scenario.key]["default"]
        if scenario.key == "control":
            kept, asked = abs(rate.share - 0.6) <= 0.06, "60 ± 6 %"
        else:
            kept, asked = rate.share >= scenario.target, f"≥ {scenario.target:.0%}"
        rows.append((f"not among the best two: {scenario.title}", asked, str(rate), kept))
    for scenario in SCENARIOS:
        if scenario.key != "control":
            rate = revived(found["selection"][scenario.key]["default"]["rejected"])
            kept = rate.share >= scenario.target
            rows.append((f"left out of the path: {scenario.title}", f"≥ {scenario.target:.0%}", str(rate), kept))
    chance = uneven(by_place(found)["default"])
    rows.append(
        (
            "control does not depend on the place in the list",
            f"p ≥ {UNEVEN_SHARE}",
            f"p = {chance:.2f}",
            chance >= UNEVEN_SHARE,
        )
    )
    for ways in GROUPINGS:
        rate = groups[ways.key]["default"]
        rows.append((f"grouping right: {ways.title}", f"≥ {ways.target:.0%}", str(rate), rate.share >= ways.target))
    for shape, modes in found["shapes"].items():
        spread = modes["default"]
        largest = spread["largest"]
        kept = spread["failed"] == 0 and largest is not None and largest <= SHAPE_BOUND
        rows.append((f"Fréchet distance: {shape}", "≤ 1 cm", worst(spread), kept))
    rows += clustering.targets(found["clustering"]) + recorded_sets.targets(found["recorded_sets"])
    return rows + ablation.targets(found["ablation"]) + adaptation_report.targets(found["adaptation"])


def print_short(found: Found) -> None:
    """Print the rates and the targets on the terminal."""
    out = Console(width=140)
    table = Table(title="Rejected: not among the two most consistent of five (95 % interval)", title_justify="left")
    for name in ("fifth demonstration has", "chance", *MODES, "default, by its own rule"):
        table.add_column(name)
    for scenario in SCENARIOS:
        of = found["selection"][scenario.key]
        rates = [str(revived(of[mode]["outranked"])) for mode in MODES]
        table.add_row(scenario.title, f"{scenario.chance:.0%}", *rates, str(revived(of["default"]["rejected"])))
    out.print(table)
    for what, asked, measured, kept in targets(found):
        if not kept:
            out.print(f"falls short: {what}: {measured}, asked {asked}")


def worst(spread: Mapping[str, Any]) -> str:
    """Return the median and the largest of a spread in words."""
    if spread["median"] is None:
        return f"failed in all {spread['n']}"
    failed = f", {spread['failed']} failed" if spread["failed"] else ""
    return f"{100 * spread['median']:.2f} cm, at most {100 * spread['largest']:.2f}{failed}"
