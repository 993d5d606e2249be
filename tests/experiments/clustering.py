"""python -m tests.experiments.clustering: how often mode default finds the right clusters, with 95 % intervals."""

from __future__ import annotations

import argparse
from dataclasses import dataclass

from rich.console import Console
from rich.table import Table

from teachpath.learning.clustering.partition import Partition
from teachpath.learning.clustering.subsampled_clustering import cluster_paths
from teachpath.learning.learn import comparable_paths
from teachpath.learning.settings import LearningSettings
from teachpath.records import Trajectory
from tests.experiments.clustering_cases import GROUPS, Case
from tests.experiments.trials import Rate, rate


@dataclass(frozen=True)
class Rates:
    """How often the clusters of a case are right, the incomplete one named and no other, and the note ambiguous."""

    right: Rate
    named: Rate
    ambiguous: Rate


def partition(shown: list[Trajectory], settings: LearningSettings) -> Partition:
    """Cluster demonstrations as learning does."""
    named = {str(number): trajectory for number, trajectory in enumerate(shown)}
    paths, length = comparable_paths(named, settings.metric, settings.seed)
    return cluster_paths(paths, settings, length=length, metric=settings.metric)


def is_right(found: Partition, truth: list[int]) -> bool:
    pairs = set(zip(found.labels.tolist(), truth, strict=True))
    return len(pairs) == len(set(truth)) == int(found.labels.max())


def measure(case: Case, runs: int, metric: str = "arc") -> Rates:
    """Cluster a case with so many seeds."""
    right, named, ambiguous = [], [], []
    for seed in range(runs):
        shown, truth = case.shown(seed)
        found = partition(shown, LearningSettings(metric=metric))
        right.append(is_right(found, truth))
        named.append(list(found.incomplete) == [0] * case.stops)
        ambiguous.append("ambiguous" in found.note)
    return Rates(rate(right), rate(named), rate(ambiguous))


def main() -> None:
    """Print the rates of all cases."""
    parser = argparse.ArgumentParser(description="Measure how often the right clusters are found.")
    parser.add_argument("--runs", type=int, default=200, help="seeds of each case")
    parser.add_argument("--metric", default="arc", help="arc, frechet, dtw or undersampled")
    asked = parser.parse_args()
    console = Console(width=150)
    for group, cases in GROUPS.items():
        heads = ("Shown", "Right", "Incomplete ones named", "Called ambiguous", "Target")
        table = Table(*heads, title=f"{group}, {asked.runs} seeds each")
        for case in cases:
            rates = measure(case, asked.runs, asked.metric)
            short = "" if rates.right.share >= case.target else "  falls short"
            told = (rates.right, rates.named, rates.ambiguous)
            table.add_row(case.title, *map(str, told), f"{case.target:.0%}{short}")
        console.print(table)


if __name__ == "__main__":
    main()
