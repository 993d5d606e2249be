"""How well learning does on demonstrations that are known to be of one way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from teachpath.errors import LearningFailed, UnusableInput
from teachpath.learning.adaptation.adapt import AdaptedPath, adapt
from teachpath.learning.adaptation.even_parameters import even_parameters
from teachpath.learning.adaptation.target import Target
from teachpath.learning.learn import learn
from teachpath.learning.resampling import at_equal_arc_length, smoothed
from teachpath.learning.settings import LearningSettings, StepCallback
from teachpath.records import Array, Trajectory

POINTS = 100  # at equal arc length, at which a path is held against a demonstration
MIN_PREDICTED_FROM = 2  # demonstrations that another one is predicted from, at least
MAX_PREDICTED = 20  # demonstrations of a way that are predicted, evenly picked
QUANTILE = 1.96  # of the normal distribution, for 95 %


@dataclass(frozen=True)
class Rate:
    """How often something happened, with the 95 % interval of Wilson (1927)."""

    hits: int
    n: int

    @property
    def share(self) -> float:
        """Of the cases in which it happened."""
        return self.hits / self.n

    @property
    def interval(self) -> tuple[float, float]:
        """In which the true share lies at 95 %."""
        z, p, n = QUANTILE, self.share, self.n
        middle = (p + z * z / (2 * n)) / (1 + z * z / n)
        half = z * sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / (1 + z * z / n)
        return max(0.0, middle - half), min(1.0, middle + half)

    def document(self) -> dict[str, object]:
        """Return it ready for JSON."""
        low, high = self.interval
        return {
            "share": round(self.share, 4),
            "hits": self.hits,
            "n": self.n,
            "interval": [round(low, 4), round(high, 4)],
        }

    def __str__(self) -> str:
        low, high = self.interval
        return f"{self.share:.1%} ({low:.1%} to {high:.1%})"


@dataclass(frozen=True)
class Predicted:
    """A demonstration as it is predicted from others, by its start and goal alone.

    Attributes:
        rms: distance [m] of the adapted path from it, at equal arc lengths.
        line: the same of the straight line.
        held: whether two standard deviations, as the path states them, hold the distance.
    """

    rms: float
    line: float
    held: bool


@dataclass(frozen=True)
class OneWay:
    """What is learned from demonstrations that are known to be of one way.

    Attributes:
        ways: that are found; one is right.
        is_ambiguous: whether another number of ways is said to do as well.
        left_out: how many are called inconsistent.
        predicted: see `predict_each`.
        unpredicted: why they cannot be predicted from one another; empty where they can, or are too few.
    """

    ways: int
    is_ambiguous: bool
    left_out: Rate
    predicted: Sequence[Predicted]
    unpredicted: str = ""


def evaluate_way(
    shown: Mapping[str, Trajectory], settings: LearningSettings, *, on_step: StepCallback = lambda: None
) -> OneWay:
    """Learn from demonstrations of one way (id -> trajectory) alone, and predict each from the others in mode default.

    Raises:
        LearningFailed: see `learn`.
    """
    learned = learn(shown, settings)
    on_step()
    selected = sum(score.selected for cluster in learned.clusters for score in cluster.scores)
    predicted, unpredicted = [], ""
    if settings.mode == "default":
        try:
            predicted = predict_each(shown, settings, on_step=on_step)
        except (LearningFailed, UnusableInput) as error:
            unpredicted = str(error)
    return OneWay(
        len(learned.clusters),
        any("ambiguous" in note for note in learned.notes),
        Rate(len(shown) - selected, len(shown)),
        predicted,
        unpredicted,
    )


def predict_each(
    shown: Mapping[str, Trajectory], settings: LearningSettings, *, on_step: StepCallback = lambda: None
) -> list[Predicted]:
    """Predict demonstrations of one way, each from all the others.

    Args:
        shown: id -> trajectory.
        settings: see `LearningSettings`.
        on_step: called once for each demonstration that is predicted.

    Returns:
        one for each demonstration, or for evenly picked ones of many; nothing where there are too few others.

    Raises:
        LearningFailed: see `learn`.
        UnusableInput: a demonstration is too short to lead anywhere.
    """
    found = []
    for name in predicted_names(shown):
        others = {other: trajectory for other, trajectory in shown.items() if other != name}
        course = at_equal_arc_length(smoothed(shown[name]), POINTS)
        made = adapted_to(others, Target(course[0], course[-1]), settings)
        path = made.curve(even_parameters(made.curve, POINTS))
        rms = _rms(path - course)
        found.append(Predicted(rms, _rms(np.linspace(course[0], course[-1], POINTS) - course), rms < two_sd(made)))
        on_step()
    return found


def predicted_names(shown: Mapping[str, Trajectory]) -> list[str]:
    """Return which demonstrations `predict_each` predicts."""
    names = list(shown)
    if len(names) <= MIN_PREDICTED_FROM:
        return []
    return [names[i] for i in np.unique(np.linspace(0, len(names) - 1, min(MAX_PREDICTED, len(names))).astype(int))]


def adapted_to(shown: Mapping[str, Trajectory], target: Target, settings: LearningSettings) -> AdaptedPath:
    """Learn from demonstrations and adapt the path of the way that most of them take, as the service does."""
    learned = learn(shown, settings)
    selected = [[score.demonstration for score in of.scores if score.selected] for of in learned.clusters]
    way = int(np.argmax([len(names) for names in selected]))
    others = [shown[name] for number, names in enumerate(selected) if number != way for name in names]
    path = learned.paths[way]
    return adapt(path, path.curve, [shown[name] for name in selected[way]], others, target, settings)


def two_sd(made: AdaptedPath) -> float:
    """Return the distance [m] that an adapted path states for two standard deviations, over the whole path."""
    return float(np.sqrt(np.mean(np.square(made.spread))))


def _rms(apart: Array) -> float:
    return float(np.sqrt(np.mean(np.square(apart).sum(axis=1))))
