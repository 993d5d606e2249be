"""python -m tests.experiments.adaptation: how well paths between new starts and goals are predicted from others.

Without --data the demonstrations are synthetic; --data names a folder of hand-polhemus recordings. Every demonstration
is predicted from n others of its hand and object, drawn at random.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.ndimage import uniform_filter1d

from teachpath.learning.adaptation.kriged_shapes import KrigedShapes, Prediction
from teachpath.learning.resampling import at_equal_arc_length, smoothed
from teachpath.records import Array
from tests.experiments.trials import Rate, rate
from tests.unit.learning import synthetic

POINTS = 100
COUNTS = (1, 2, 3, 5, 8)
LABEL_ERRORS = {"user1_spray_can5", "user2_b_jug0", "user2_b_jug3"}  # files whose labels have typing errors
SHARE = np.linspace(0.0, 1.0, POINTS)[:, None]

Method = Callable[[Array, Array, Array], Array]


@dataclass(frozen=True)
class Errors:
    """Distances [m] of predictions from what was shown, and how often twice the deviation holds them."""

    rms: Array
    largest: Array
    held: Rate | None


def straight_line(_shown: Array, start: Array, goal: Array) -> Array:
    return np.asarray(start + SHARE * (goal - start))


def mean_shape(shown: Array, start: Array, goal: Array) -> Array:
    """The mean of what demonstrations have beside the straight line, in the world."""
    lines = shown[:, :1] + SHARE * (shown[:, -1:] - shown[:, :1])
    return np.asarray(straight_line(shown, start, goal) + (shown - lines).mean(axis=0))


def kriged(shown: Array, start: Array, goal: Array) -> Prediction:
    return KrigedShapes(shown).predict(start, goal)


def synthetic_sets(count: int = 12) -> dict[str, Array]:
    """Demonstrations of three ways, each to goals that scatter by 12 cm, from starts that do likewise."""
    sets = {}
    for way, vias in enumerate(synthetic.WAYS):
        rng = np.random.default_rng([way, 21])
        courses = []
        for _ in range(count):
            goal = synthetic.GOAL + rng.normal(0, 0.12, 3) * [1, 1, 0.2]
            shown = smoothed(synthetic.demonstration(rng, vias, goal=goal))
            courses.append(at_equal_arc_length(shown, POINTS) + rng.normal(0, 0.1, 3))
        sets[f"way {way + 1}"] = np.array(courses)
    return sets


def recorded_sets(folder: Path) -> dict[str, Array]:
    """The transports of recordings, from the one labelled place to the other, by hand and object."""
    sets: dict[str, list[Array]] = {}
    for file in sorted(folder.glob("*.traj")):
        if file.stem not in LABEL_ERRORS:
            sets.setdefault(re.sub(r"\d+$", "", file.stem), []).append(_transport(file))
    return {name: np.array(courses) for name, courses in sets.items()}


def _transport(file: Path) -> Array:
    positions = np.array(file.read_text().split(), dtype=float).reshape(-1, 4, 4)[:, :3, 3]
    labels = np.array(Path(f"{file}.res").read_text().split(), dtype=float).reshape(2, 3)
    first, last = sorted(int(np.argmin(np.linalg.norm(positions - label, axis=1))) for label in labels)
    path = positions[first : last + 1]
    path = path[np.append(True, np.any(np.diff(path, axis=0), axis=1))]  # stale readings
    smooth = uniform_filter1d(path, 9, axis=0, mode="nearest")
    smooth[[0, -1]] = path[[0, -1]]
    return at_equal_arc_length(smooth, POINTS)


def measure(
    sets: dict[str, Array],
    count: int,
    method: Callable[[Array, Array, Array], Array | Prediction],
    runs: int,
    seed: int,
) -> Errors:
    """Predict random demonstrations of every set from `count` others."""
    rng = np.random.default_rng([seed, count])
    rms, largest, held = [], [], []
    for courses in sets.values():
        for _ in range(runs if len(courses) > count else 0):
            left_out, *others = rng.permutation(len(courses))[: count + 1]
            truth = courses[left_out]
            found = method(courses[others], truth[0], truth[-1])
            path = found.path if isinstance(found, Prediction) else found
            off = np.linalg.norm(path - truth, axis=1)
            rms.append(np.sqrt(np.mean(off**2)))
            largest.append(off.max())
            if isinstance(found, Prediction):
                held.append(bool(rms[-1] < 2 * np.sqrt(np.mean(found.deviation**2))))
    return Errors(np.array(rms), np.array(largest), rate(held) if held else None)


METHODS = {"straight line": straight_line, "mean shape": mean_shape, "kriged shapes": kriged}


def main() -> None:
    """Print the errors of every method for every number of demonstrations."""
    parser = argparse.ArgumentParser(description="Measure how well paths between new ends are predicted.")
    parser.add_argument("--data", type=Path, help="folder of hand-polhemus; without it synthetic demonstrations")
    parser.add_argument("--runs", type=int, default=100, help="predictions for each set and number")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    sets = recorded_sets(asked.data) if asked.data else synthetic_sets()
    heads = ("n", "Method", "RMS median/p90 [cm]", "of the line's", "Largest, of the line's", "Held by two deviations")
    table = Table(*heads, title=f"{len(sets)} sets, {asked.runs} predictions each")
    for count in COUNTS:
        line = measure(sets, count, straight_line, asked.runs, asked.seed)
        for name, method in METHODS.items():
            errors = measure(sets, count, method, asked.runs, asked.seed)
            median, most = 100 * np.quantile(errors.rms, [0.5, 0.9])
            share = np.median(errors.rms) / np.median(line.rms)
            largest = np.median(errors.largest) / np.median(line.largest)
            held = str(errors.held or "")
            table.add_row(str(count), name, f"{median:.2f}/{most:.2f}", f"{share:.2f}", f"{largest:.2f}", held)
    Console(width=130).print(table)


if __name__ == "__main__":
    main()
