"""What the report says of selection: the table of scenarios, what is left out wrongly, and the control."""

from __future__ import annotations

from html import escape
from pathlib import Path

from scipy.stats import binom

from teachpath.learning.evaluation import Rate
from tests.experiments import (
    curves,
    rule,
)
from tests.experiments.markup import figure, short
from tests.experiments.results import Found, by_place, revived, uneven
from tests.experiments.scenarios import SCENARIOS
from tests.experiments.trials import BY_KEY, MODES


def selection_section(found: Found, folder: Path) -> list[str]:
    sizes = found["sizes"]
    spread = found["repetitions"]["rates"]["paper"]
    low, high = binom.interval(0.95, sizes["repetitions"], 0.6)
    head = "<th class=l>Spoilt by<th>n<th>chance" + "".join(f"<th>mode {mode}" for mode in MODES)
    head += "<th>default,<br>own rule<th>others<br>rejected"
    rows = []
    for scenario in SCENARIOS:
        of = found["selection"][scenario.key]
        rates: list[Rate] = [revived(of[mode]["outranked"]) for mode in MODES]
        cells = "".join(f"<td>{short(rate)}" for rate in rates)
        own = f"<td>{short(revived(of['default']['rejected']))}<td>{100 * of['default']['unmarked_rejected']:.1f}"
        rows.append(f"<tr><td>{escape(scenario.title)}<td>{rates[0].n}<td>{scenario.chance:.0%}{cells}{own}")
    return [
        "<h2>Experiment 2: which demonstration is inconsistent?</h2>",
        "<p>Five demonstrations of one way, 200 samples each; the fifth wiggles at 1.5 to 3 Hz.</p>",
        figure(
            folder, "fig6_wiggles", "Fig. 6.", "Five demonstrations and the learned NURBS of each mode, one data set."
        ),
        curves.table({"1": found["experiment_1"], "2": found["experiment_2"]}),
        "<p>The publication repeats the selection 1000 times on one data set. Here every run draws new "
        "demonstrations and lists them in random order, so that neither one lucky data set nor a place in the list "
        "can make the figure. A demonstration counts as rejected when it is not among the two most consistent; with "
        "two of five kept, blind choice rejects a given one in 60 % of the runs and two given ones in 30 %.</p>",
        figure(
            folder,
            "rejection",
            "Fig. 7.",
            "Rate at which the spoilt demonstration is rejected, with 95 % intervals (Wilson). Pause, freeze, spike "
            "and detour begin or peak somewhere between 30 and 70 % of the time.",
        ),
        "<table><caption><b>Table II.</b> The rates of Fig. 7 in per cent. Mode default keeps more than two when "
        "they are consistent; by its own rule a demonstration is rejected when its z is below the limit. The last "
        "column is how often that happens to the demonstrations that were not "
        f"spoilt.</caption><tr>{head}{''.join(rows)}</table>",
        *_failures(found),
        figure(
            folder,
            "rule",
            "Fig. 8.",
            "What mode default leaves out of the path, over the limit of z; grey: the limit shipped. Left the spoilt "
            "ones, right the others in the same runs.",
        ),
        rule.table(found["rule"]),
        figure(
            folder,
            "repetitions",
            "Fig. 9.",
            f"The published protocol: {sizes['repetitions']} repetitions of the selection on one data set, for "
            f"{sizes['datasets']} data sets. In mode paper the rate is {min(spread):.0%} to {max(spread):.0%}; of "
            f"blind choices 95 % lie from {low / sizes['repetitions']:.0%} to {high / sizes['repetitions']:.0%}.",
        ),
    ]


def _failures(found: Found) -> list[str]:
    counts = [
        f"{of['failed']} of {of['outranked']['n']} runs of “{BY_KEY[key].title}” in mode {mode}"
        for key, modes in found["selection"].items()
        for mode, of in modes.items()
        if of["failed"]
    ]
    if not counts:
        return []
    return [
        f"<p>No path could be learned in {escape('; '.join(counts))}: the fit missed its bound. It counts as kept.</p>"
    ]


def control_section(found: Found, folder: Path) -> list[str]:
    chances = ", ".join(f"{uneven(rates):.2f} (mode {mode})" for mode, rates in by_place(found).items())
    return [
        "<h2>The control: nobody is inconsistent</h2>",
        "<p>The same runs without a wiggle. A method that rejects the marked demonstration more often than chance, "
        "or more often at some place in the list, would owe its success to the list and not to the wiggle.</p>",
        figure(
            folder,
            "places",
            "Fig. 10.",
            "Rate at which a demonstration like the others is rejected, by its place in the list, with 95 % "
            "intervals; dashed: chance, grey: 60 ± 6 %. If the place made no difference, rates so uneven would come up "
            f"with probability {chances}.",
        ),
    ]
