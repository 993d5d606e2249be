"""python -m tests.experiments.clustering: how often mode default finds the right clusters, with 95 % intervals."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from teachpath.learning.clustering.dendrogram import Labels, labels_for_count
from teachpath.learning.clustering.partition import Partition
from teachpath.learning.clustering.subsampled_clustering import cluster_paths
from teachpath.learning.evaluation import Rate
from teachpath.learning.learn import comparable_paths
from teachpath.learning.settings import LearningSettings
from teachpath.records import Trajectory
from tests.experiments.clustering_cases import GROUPS
from tests.experiments.trials import rate

CASES = {f"{group}: {case.title}": case for group, cases in GROUPS.items() for case in cases}
HEADS = ("Right", "Right, or the next cut", "Incomplete ones named", "Called ambiguous")


def partition(shown: list[Trajectory], settings: LearningSettings) -> Partition:
    """Cluster demonstrations as learning does."""
    named = {str(number): trajectory for number, trajectory in enumerate(shown)}
    paths, length = comparable_paths(named, settings.metric, settings.seed)
    return cluster_paths(paths, settings, length=length, metric=settings.metric)


def is_right(labels: Labels, truth: list[int]) -> bool:
    pairs = set(zip(labels.tolist(), truth, strict=True))
    return len(pairs) == len(set(truth)) == int(labels.max())


def cluster_once(key: str, seed: int, metric: str = "arc") -> tuple[bool, bool, bool, bool]:
    """Return whether the clusters of one drawing of a case are right, and the other three of `HEADS`."""
    shown, truth = CASES[key].shown(seed)
    found = partition(shown, LearningSettings(metric=metric))
    right = is_right(found.labels, truth)
    doubted = found.alternative and is_right(labels_for_count(found.linkage, found.alternative), truth)
    return right, right or bool(doubted), list(found.incomplete) == [0] * CASES[key].stops, "ambiguous" in found.note


def summary(found: Sequence[tuple[str, tuple[bool, bool, bool, bool]]]) -> dict[str, Any]:
    """Return for every case the four rates."""
    return {
        key: [rate(list(told)).document() for told in zip(*(one for name, one in found if name == key), strict=True)]
        for key in CASES
    }


def table(found: Mapping[str, Any]) -> str:
    """Return the rates as a table of the report."""
    rows = []
    for key, case in CASES.items():
        cells = "".join(f"<td>{_revived(one)}" for one in found[key])
        rows.append(f"<tr><td>{key}<td>≥ {case.target:.0%}{cells}")
    return (
        "<h2>Clusters of many kinds</h2><table><caption><b>Table IX.</b> How often mode default finds the clusters, "
        "over other demonstrations each time, with 95 % intervals. Ways that differ in a third of the path may be "
        "called doubtful instead, if the next cut is right.</caption>"
        f"<tr><th class=l>Shown<th>asked<th>{'<th>'.join(HEADS)}{''.join(rows)}</table>"
    )


def targets(found: Mapping[str, Any]) -> list[tuple[str, str, str, bool]]:
    """Return what is asked: what, how much, what was measured, whether it is kept."""
    rows = []
    for key, case in CASES.items():
        reached = _revived(found[key][1 if case.doubt else 0])
        rows.append((f"clustering: {key}", f"≥ {case.target:.0%}", str(reached), reached.share >= case.target))
        if case.stops:
            named = _revived(found[key][2])
            rows.append((f"incomplete named: {key}", f"≥ {case.target:.0%}", str(named), named.share >= case.target))
        if case.called < 1:
            called = _revived(found[key][3])
            rows.append((f"called ambiguous: {key}", f"≤ {case.called:.0%}", str(called), called.share <= case.called))
    return rows


def _revived(document: Mapping[str, Any]) -> Rate:
    return Rate(document["hits"], document["n"])


def main() -> None:
    """Print the rates of all cases."""
    parser = argparse.ArgumentParser(description="Measure how often the right clusters are found.")
    parser.add_argument("--runs", type=int, default=200, help="seeds of each case")
    parser.add_argument("--first", type=int, default=0, help="first of the seeds")
    parser.add_argument("--metric", default="arc", help="arc, frechet, dtw or undersampled")
    asked = parser.parse_args()
    seeds = range(asked.first, asked.first + asked.runs)
    console = Console(width=200)
    table = Table("Shown", *HEADS, "Target", title=f"{asked.runs} seeds each")
    found = summary([(key, cluster_once(key, seed, asked.metric)) for key in CASES for seed in seeds])
    for key, case in CASES.items():
        table.add_row(key, *(str(_revived(one)) for one in found[key]), f"{case.target:.0%}")
    console.print(table)
    for what, wanted, measured, kept in targets(found):
        if not kept:
            console.print(f"falls short: {what}: {measured}, asked {wanted}")


if __name__ == "__main__":
    main()
