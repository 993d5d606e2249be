"""From single outcomes to rates: the numbers that figures, report and JSON share."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from statistics import median
from typing import Any

import numpy as np
from scipy.stats import chi2_contingency

from teachpath.learning.evaluation import Rate
from teachpath.records import Learned, Trajectory
from tests.experiments import degrees, rule, scale
from tests.experiments.scenarios import GROUPINGS, SCENARIOS, SHAPES
from tests.experiments.trials import MODES, Outcome, rate, settled, strays

Found = dict[str, Any]


def summary(
    selections: list[Any],
    groupings: list[Any],
    shapes: list[Any],
    repeated: list[Any],
    scales: list[Any],
    fits: list[Any],
    *,
    sizes: Any,
) -> Found:
    """Return every repeated figure, ready for JSON.

    Args:
        selections, groupings, shapes, repeated, scales, fits: pairs of arguments and outcome, see `trials`.
        sizes: how often each was run.
    """
    outcomes = [outcome for _, several in selections for outcome in several]
    return {
        "sizes": asdict(sizes),
        "selection": {s.key: {mode: _selection(outcomes, s.key, mode) for mode in MODES} for s in SCENARIOS},
        "grouping": {
            ways.key: {
                mode: _grouping([found[mode] for (key, _), found in groupings if key == ways.key])
                for mode in ("paper", "default")
            }
            for ways in GROUPINGS
        },
        "shapes": {
            shape: {mode: _spread(found[mode] for (key, _), found in shapes if key == shape) for mode in MODES}
            for shape in SHAPES
        },
        "rule": rule.summary(outcomes),
        "scale": scale.summary([found for _, found in scales]),
        "degrees": degrees.summary([(kind, found) for (kind, _), found in fits]),
        "repetitions": {"rates": {mode: [found[mode] for _, found in repeated] for mode in ("paper", "repaired")}},
    }


def single(learned: Mapping[str, Learned], demonstrations: dict[str, Trajectory]) -> Found:
    """Return scores, convergence and fits of one run in every mode."""
    return {
        mode: [_cluster(result, i, demonstrations) for i in range(len(result.clusters))]
        for mode, result in learned.items()
    }


def outranked(found: Found) -> dict[str, dict[str, Rate]]:
    """Return for every scenario and mode how often the marked were not among the two best."""
    return {k: {mode: revived(v["outranked"]) for mode, v in modes.items()} for k, modes in found["selection"].items()}


def by_place(found: Found) -> dict[str, list[Rate | None]]:
    """Return for every mode the rates of the control by place in the list, None where there was no run."""
    control = found["selection"]["control"]
    return {mode: [place and revived(place) for place in control[mode]["by_place"]] for mode in MODES}


def uneven(rates: list[Rate | None]) -> float:
    """Return the probability of rates at least as different as these when they are all one (chi-squared test)."""
    counts = [(rate.hits, rate.n - rate.hits) for rate in rates if rate]
    if 0 in np.sum(counts, axis=0):
        return 1.0
    return float(chi2_contingency(counts).pvalue)


def right(found: Found) -> dict[str, dict[str, Rate]]:
    """Return for every grouping and mode how often it is right."""
    return {k: {mode: revived(v["right"]) for mode, v in modes.items()} for k, modes in found["grouping"].items()}


def revived(document: Mapping[str, Any]) -> Rate:
    """Return the rate of its document."""
    return Rate(document["hits"], document["n"])


def _selection(outcomes: Iterable[Outcome], key: str, mode: str) -> Found:
    mine = [outcome for outcome in outcomes if (outcome.scenario, outcome.mode) == (key, mode)]
    places = [[o.outranked for o in mine if o.places == (place,)] for place in range(1, 6)]
    return {
        "outranked": rate([o.outranked for o in mine]).document(),
        "rejected": rate([o.rejected for o in mine]).document(),
        "one_cluster": rate([o.whole for o in mine]).document(),
        "failed": sum(bool(o.failed) for o in mine),
        "unmarked_rejected": round(sum(o.unmarked_rejected for o in mine) / len(mine), 4),
        "by_place": [rate(hits).document() if hits else None for hits in places],
    }


def _grouping(found: list[tuple[bool, int]]) -> Found:
    counts = Counter(count for _, count in found)
    return {"right": rate([r for r, _ in found]).document(), "clusters": {str(k): counts[k] for k in sorted(counts)}}


def _spread(values: Iterable[float | None]) -> Found:
    listed = list(values)
    known = [value for value in listed if value is not None]
    return {
        "n": len(listed),
        "failed": len(listed) - len(known),
        "median": round(median(known), 5) if known else None,
        "largest": round(max(known), 5) if known else None,
    }


def _cluster(learned: Learned, at: int, demonstrations: dict[str, Trajectory]) -> Found:
    cluster = learned.clusters[at]
    path = next(path for path in learned.paths if path.cluster == cluster.index)
    away, short = strays(learned, cluster.index, demonstrations)
    return {
        "cluster": cluster.index,
        "scores": [
            {
                "demonstration": int(score.demonstration),
                "log_likelihood": round(score.log_likelihood, 3),
                "z": None if score.z is None else round(score.z, 2),
                "selected": score.selected,
                "note": score.note,
            }
            for score in cluster.scores
        ],
        "convergence": [round(value, 3) for value in cluster.convergence],
        "settled": settled(cluster.convergence) if len(cluster.convergence) else None,
        "degree": path.curve.degree,
        "control_points": len(path.curve.control_points),
        "fit": {k: None if v is None else round(v, 6) for k, v in asdict(path.fit).items()},
        "away_from_samples": round(away, 5),
        "end_from_goal": round(short, 5),
        "note": path.note,
    }
