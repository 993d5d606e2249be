"""python -m tests.experiments.recorded_sets --data FOLDER: whether learning tells the tasks of recorded sets apart.

The folder holds one set for each task, as an array (demonstrations, samples, coordinates) in a file NAME.npy: positions
[cm], and behind them what is not used here. The sets are mixed and learned from as if all were of one task.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from teachpath.learning.evaluation import Rate
from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath.records import Trajectory
from tests.experiments.trials import rate

UNIT = 0.01  # m
PERIOD = 0.01  # s, between two samples; the files do not say it, and the path has no time
COUNTS = (2, 3, 5)  # demonstrations of each set that are drawn at random
MAX_LEFT_OUT = 0.04  # asked, of all that were recorded
SETTINGS = LearningSettings(repeats=0)  # the repetitions change no path


@dataclass(frozen=True)
class Mixture:
    """What was learned from a mixture of sets.

    Attributes:
        exact: whether the clusters are the sets.
        left_out: for each demonstration, whether it goes into no path.
    """

    exact: bool
    left_out: tuple[bool, ...]


def read_sets(folder: Path) -> dict[str, list[Trajectory]]:
    """Read the sets of a folder by their names."""
    found = {}
    for file in sorted(folder.glob("*.npy")):
        arrays = UNIT * np.load(file)[:, :, :3]
        found[file.stem] = [Trajectory(PERIOD * np.arange(len(each)), each) for each in arrays]
    return found


def mixed_once(folder: Path, count: int | None, seed: int) -> Mixture:
    """Learn from `count` of each set, or from all, in random order."""
    rng = np.random.default_rng([seed, 36])
    drawn = [
        (name, shown[i])
        for name, shown in read_sets(folder).items()
        for i in rng.permutation(len(shown))[:count].tolist()
    ]
    drawn = [drawn[i] for i in rng.permutation(len(drawn)).tolist()]
    learned = learn({str(number): trajectory for number, (_, trajectory) in enumerate(drawn)}, SETTINGS)
    pairs = {(cluster.index, drawn[int(member)][0]) for cluster in learned.clusters for member in cluster.members}
    exact = len(pairs) == len(learned.clusters) == len({name for name, _ in drawn})
    return Mixture(exact, tuple(not score.selected for cluster in learned.clusters for score in cluster.scores))


def drawn_counts(runs: int) -> list[int | None]:
    """Return how many of each set every mixture takes, `runs` times each number; None: all, a tenth as often."""
    return [None] * max(1, runs // 10) + [count for count in COUNTS for _ in range(runs)]


def summary(found: Iterable[tuple[int | None, Mixture]]) -> list[dict[str, Any]]:
    """Return for every count, None for all of each set, how often the clusters are the sets, and who is left out."""
    mixtures: dict[int | None, list[Mixture]] = {}
    for count, mixture in found:
        mixtures.setdefault(count, []).append(mixture)
    return [
        {
            "n": count,
            "exact": rate([mixture.exact for mixture in each]).document(),
            "left_out": rate([out for mixture in each for out in mixture.left_out]).document(),
        }
        for count, each in mixtures.items()
    ]


def targets(rows: Iterable[Mapping[str, Any]]) -> list[tuple[str, str, str, bool]]:
    """Return what is asked of all that was recorded: what, how much, what was measured, whether it is kept."""
    told = []
    for row in rows:
        if row["n"] is None:
            exact, out = _revived(row["exact"]), _revived(row["left_out"])
            told.append(("recorded sets: told apart", "always", str(exact), exact.hits == exact.n))
            told.append(("recorded sets: left out", f"≤ {MAX_LEFT_OUT:.0%}", str(out), out.share <= MAX_LEFT_OUT))
    return told


def section(rows: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return the part of the report about recorded sets, as HTML; none without them."""
    lines = [f"<tr><td>{row['n'] or 'all'}<td>{_revived(row['exact'])}<td>{_revived(row['left_out'])}" for row in rows]
    if not lines:
        return []
    return [
        "<h2>Recorded sets</h2>",
        "<p>Recordings of an arm that was led through several tasks are mixed and learned from as if all were of one. "
        "A few of each are drawn at random; all of them come in random orders.</p>",
        "<table><tr><th class=l>Of each task<th>clusters are the tasks<th>demonstrations left out"
        f"{''.join(lines)}</table>",
    ]


def _revived(document: Mapping[str, Any]) -> Rate:
    return Rate(document["hits"], document["n"])


def main() -> None:
    """Print the rates."""
    parser = argparse.ArgumentParser(description="Measure whether the tasks of recorded sets are told apart.")
    parser.add_argument("--data", type=Path, required=True, help="folder with a file NAME.npy for each task")
    parser.add_argument("--runs", type=int, default=40, help="mixtures of each number")
    parser.add_argument("--first", type=int, default=0, help="first of their seeds")
    asked = parser.parse_args()
    counts = drawn_counts(asked.runs)
    found = [(count, mixed_once(asked.data, count, asked.first + seed)) for seed, count in enumerate(counts)]
    for row in summary(found):
        exact, out = _revived(row["exact"]), _revived(row["left_out"])
        print(f"{row['n'] or 'all'} of each: clusters are the tasks {exact} of {exact.n}, left out {out} of {out.n}")


if __name__ == "__main__":
    main()
