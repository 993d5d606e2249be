"""python -m tests.experiments.adaptation: how well paths between new starts and goals are predicted from others.

Without --data the demonstrations are synthetic; --data names a folder of hand-polhemus recordings. Every demonstration
is predicted from n others of its hand and object, drawn at random. Medians are of distances at equal arc lengths.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.spatial.transform import Rotation

from teachpath.learning.adaptation.even_parameters import even_parameters
from teachpath.learning.adaptation.target import Target
from teachpath.learning.evaluation import adapted_to, two_sd
from teachpath.learning.fitting.orientation_fit import mean_orientations, rotation_angles
from teachpath.learning.resampling import at_equal_arc_length, smoothed
from teachpath.learning.settings import LearningSettings
from teachpath.nurbs import unit_quaternions
from teachpath.records import Array, Trajectory
from tests.experiments import adaptation_baselines as baselines
from tests.experiments import adaptation_report
from tests.experiments.adaptation_report import LINE, METHOD_NAMES, SAME_FRAME, Row
from tests.experiments.trials import rate
from tests.unit.learning import synthetic

POINTS = 100
COUNTS = (1, 3, 5, 8)
LABEL_ERRORS = {"user1_spray_can5", "user2_b_jug0", "user2_b_jug3"}  # files whose labels have typing errors
SAMPLING_PERIOD = 0.01  # s, of the recordings
SETTINGS = LearningSettings(repeats=0)  # the repetitions change no path
RESAMPLES = 1000  # of the bootstrap

Method = Callable[[Array, Array, Array], Array]
METHODS: dict[str, Method] = {
    LINE: baselines.straight_line,
    "mean shape": baselines.mean_shape,
    "DMP": baselines.dmp,
    "DMP, same frame": baselines.dmp_scaled,
    "ProMP": baselines.promp,
    "TP-GMM": baselines.tp_gmm,
    SAME_FRAME: baselines.tp_gmm_scaled,
}


@dataclass(frozen=True)
class Prediction:
    """One demonstration as every method predicts it from others.

    Attributes:
        rms: distance [m] by method.
        largest: likewise.
        held: whether two standard deviations hold the distance of the adapted path.
        turn: distance [rad] of its orientations, both ends given; None without orientations.
    """

    rms: dict[str, float]
    largest: dict[str, float]
    held: bool
    turn: float | None


def synthetic_sets(count: int = 12) -> dict[str, list[Trajectory]]:
    """Demonstrations of three ways, each from starts and to goals that scatter by 12 cm."""
    sets = {}
    for way, vias in enumerate(synthetic.WAY_POINTS):
        rng = np.random.default_rng([way, 21])
        shown = {}
        for number in range(count):
            goal = synthetic.GOAL + rng.normal(0, 0.12, 3) * [1, 1, 0.2]
            one = synthetic.demonstration(rng, vias, goal=goal)
            shown[str(number)] = replace(one, positions=one.positions + rng.normal(0, 0.1, 3))
        sets[f"way {way + 1}"] = list(synthetic.turning(shown).values())
    return sets


def recorded_sets(folder: Path) -> dict[str, list[Trajectory]]:
    """The transports of recordings, from the one labelled place to the other, by hand and object."""
    sets: dict[str, list[Trajectory]] = {}
    for file in sorted(folder.glob("*.traj")):
        if file.stem not in LABEL_ERRORS:
            sets.setdefault(re.sub(r"\d+$", "", file.stem), []).append(_transport(file))
    return sets


def _transport(file: Path) -> Trajectory:
    poses = np.array(file.read_text().split(), dtype=float).reshape(-1, 4, 4)
    labels = np.array(Path(f"{file}.res").read_text().split(), dtype=float).reshape(2, 3)
    first, last = sorted(int(np.argmin(np.linalg.norm(poses[:, :3, 3] - label, axis=1))) for label in labels)
    poses = poses[first : last + 1]
    poses = poses[np.append(True, np.any(np.diff(poses[:, :3, 3], axis=0), axis=1))]  # without stale readings
    # Nine readings are averaged, as of any tracker of 50 Hz.
    quaternions = Rotation.from_matrix(poses[:, :3, :3]).as_quat(scalar_first=True)
    return Trajectory(2 * SAMPLING_PERIOD * np.arange(len(poses)), poses[:, :3, 3], quaternions)


def predict(shown: Sequence[Trajectory], truth: Trajectory) -> Prediction:
    """Predict a demonstration from others by every method."""
    course = at_equal_arc_length(smoothed(truth), POINTS)
    courses = np.array([at_equal_arc_length(smoothed(each), POINTS) for each in shown])
    paths = {name: method(courses, course[0], course[-1]) for name, method in METHODS.items()}
    turns = mean_orientations([truth], POINTS)
    target = Target(course[0], course[-1], *([] if turns is None else turns[[0, -1]]))
    found = adapted_to({str(number): each for number, each in enumerate(shown)}, target, SETTINGS)
    u = even_parameters(found.curve, POINTS)
    paths[METHOD_NAMES] = found.curve(u)
    off = {name: np.linalg.norm(path - course, axis=1) for name, path in paths.items()}
    rms = {name: float(np.sqrt(np.mean(each**2))) for name, each in off.items()}
    turn = None
    if found.orientation is not None and turns is not None:
        turn = float(np.sqrt(np.mean(rotation_angles(unit_quaternions(found.orientation, u), turns) ** 2)))
    largest = {name: float(each.max()) for name, each in off.items()}
    return Prediction(rms, largest, rms[METHOD_NAMES] < two_sd(found), turn)


def measure(folder: Path | None, count: int, runs: int, seed: int) -> list[Prediction]:
    """Predict random demonstrations of every set from `count` others; None = of the synthetic sets."""
    rng = np.random.default_rng([seed, count])
    found = []
    for shown in (synthetic_sets() if folder is None else recorded_sets(folder)).values():
        for _ in range(runs if len(shown) > count else 0):
            left_out, *others = rng.permutation(len(shown))[: count + 1]
            found.append(predict([shown[other] for other in others], shown[left_out]))
    return found


def summary(found: Mapping[int, Sequence[Prediction]]) -> list[Row]:
    """Summarize every method for every number of demonstrations; distances in metres, shares of the straight line's."""
    return [_row(count, name, of) for count, of in found.items() for name in (*METHODS, METHOD_NAMES)]


def _row(count: int, name: str, found: Sequence[Prediction]) -> Row:
    rms, line = (np.array([each.rms[method] for each in found]) for method in (name, LINE))
    largest, line_largest = (np.median([each.largest[method] for each in found]) for method in (name, LINE))
    row = {
        "n": count,
        "method": name,
        "median": float(np.median(rms)),
        "p90": float(np.quantile(rms, 0.9)),
        "share": float(np.median(rms) / np.median(line)),
        "interval": _interval(rms, line),
        "largest": float(largest / line_largest),
    }
    if name == METHOD_NAMES:
        turns = [each.turn for each in found if each.turn is not None]
        row["held"] = rate([each.held for each in found]).document()
        row["turn"] = float(np.degrees(np.median(turns))) if turns else None
    return row


def _interval(rms: Array, line: Array) -> list[float]:
    """Return the 95 % interval of the ratio of medians, by bootstrap over the predictions."""
    drawn = np.random.default_rng(0).integers(len(rms), size=(RESAMPLES, len(rms)))
    ratios = np.median(rms[drawn], axis=1) / np.median(line[drawn], axis=1)
    return [float(each) for each in np.quantile(ratios, [0.025, 0.975])]


def main() -> None:
    """Print the errors of every method for every number of demonstrations."""
    parser = argparse.ArgumentParser(description="Measure how well paths between new ends are predicted.")
    parser.add_argument("--data", type=Path, help="folder of hand-polhemus; without it synthetic demonstrations")
    parser.add_argument("--runs", type=int, default=100, help="predictions for each set and number")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    heads = (
        "n",
        "Method",
        "RMS median/p90 [cm]",
        "of the line's",
        "Largest, of the line's",
        "Held by two sd",
        "Turn [°]",
    )
    table = Table(*heads, title=f"{asked.runs} predictions of each set")
    rows = summary({count: measure(asked.data, count, asked.runs, asked.seed) for count in COUNTS})
    for row in rows:
        low, high = row["interval"]
        share = f"{row['share']:.2f} ({low:.2f} to {high:.2f})"
        distances = f"{100 * row['median']:.2f}/{100 * row['p90']:.2f}"
        held = f"{row['held']['share']:.1%}" if "held" in row else ""
        turn = f"{row['turn']:.1f}" if row.get("turn") else ""
        table.add_row(str(row["n"]), row["method"], distances, share, f"{row['largest']:.2f}", held, turn)
    out = Console(width=130)
    out.print(table)
    for what, wanted, measured, kept in adaptation_report.targets(rows):
        out.print(f"{'kept' if kept else 'falls short'}: {what}: {measured}, asked {wanted}", highlight=False)


if __name__ == "__main__":
    main()
