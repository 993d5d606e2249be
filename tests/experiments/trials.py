"""The experiments themselves: one run of each kind, cheap to send to another process, and rates with intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from teachpath.errors import LearningFailed
from teachpath.learning.evaluation import Rate
from teachpath.learning.learn import learn
from teachpath.learning.matching import frechet_distance
from teachpath.learning.resampling import at_equal_arc_length
from teachpath.learning.settings import LearningSettings
from teachpath.records import Array, Cluster, Learned, Trajectory
from tests.experiments.scenarios import GROUPINGS, SCENARIOS, along, drawn
from tests.unit.learning import synthetic

MODES = ("paper", "repaired", "default")
THRESHOLD = 0.08  # m, of the modes that cut at a constant distance
BY_KEY = {scenario.key: scenario for scenario in SCENARIOS}
GROUPING = {ways.key: ways for ways in GROUPINGS}


def settings(mode: str, seed: int, *, repeats: int = 0, threshold: float = THRESHOLD) -> LearningSettings:
    return LearningSettings(mode=mode, seed=seed, repeats=repeats, threshold=None if mode == "default" else threshold)


@dataclass(frozen=True)
class Outcome:
    """What became of the marked demonstrations in one run of one mode.

    Attributes:
        places: of the marked ones in the list, from 1.
        outranked: whether all of them are behind the two best of their cluster.
        rejected: whether none of them goes into a learned path.
        unmarked_rejected: share of the others that goes into no learned path.
        whole: whether the five were taken for one way.
        marked_z, unmarked_z: rank and z of each of them, z only where the mode gives it.
        failed: why nothing was learned, which counts as not rejected; empty when something was.
    """

    scenario: str
    mode: str
    places: tuple[int, ...]
    outranked: bool
    rejected: bool
    unmarked_rejected: float
    whole: bool
    marked_z: tuple[tuple[int, float], ...] = ()
    unmarked_z: tuple[tuple[int, float], ...] = ()
    failed: str = ""


def select_once(key: str, run: int) -> list[Outcome]:
    """Learn from one drawing of a scenario in every mode."""
    demonstrations, marked = drawn(BY_KEY[key], run)
    outcomes = []
    for mode in MODES:
        try:
            learned = learn(demonstrations, settings(mode, run))
        except LearningFailed as failure:
            outcomes.append(Outcome(key, mode, _places(marked), False, False, 0.0, False, failed=str(failure)))
            continue
        scores = {score.demonstration: score for cluster in learned.clusters for score in cluster.scores}
        others = [not score.selected for name, score in scores.items() if name not in marked]
        outcomes.append(
            Outcome(
                key,
                mode,
                _places(marked),
                all(scores[name].rank > 2 for name in marked),
                all(not scores[name].selected for name in marked),
                float(np.mean(others)),
                len(learned.clusters) == 1,
                tuple((scores[name].rank, scores[name].z or 0.0) for name in sorted(marked)),
                tuple((score.rank, score.z or 0.0) for name, score in sorted(scores.items()) if name not in marked),
            )
        )
    return outcomes


def group_once(key: str, seed: int) -> dict[str, tuple[bool, int]]:
    """Return for every mode whether the grouping is right, and the number of clusters."""
    ways = GROUPING[key]
    demonstrations = ways.shown(seed)
    found = {}
    for mode in ("paper", "default"):
        learned = learn(demonstrations, settings(mode, seed))
        label = {name: cluster.index for cluster in learned.clusters for name in cluster.members}
        pairs = set(zip((label[name] for name in demonstrations), ways.truth, strict=True))
        right = len(pairs) == len(set(ways.truth)) == len(learned.clusters)
        found[mode] = (right, len(learned.clusters))
    return found


def fit_once(shape: str, seed: int) -> dict[str, float | None]:
    """Return for every mode the Fréchet distance [m] of the learned path from the clean mean; None when it fails."""
    demonstrations, mean = along(shape, seed)
    apart: dict[str, float | None] = {}
    for mode in MODES:
        try:
            learned = learn(demonstrations, settings(mode, seed, threshold=1.0))
        except LearningFailed:
            apart[mode] = None
            continue
        path = max(learned.paths, key=lambda path: len(_of(learned, path.cluster).members))
        apart[mode] = frechet_distance(at_equal_arc_length(path.curve(np.linspace(0, 1, 1000)), len(mean)), mean)
    return apart


def repeat_once(dataset: int, seeds: int) -> dict[str, float]:
    """Return how often the wiggly one of one data set is rejected over seeds of learning, as the paper repeated it."""
    demonstrations = synthetic.experiment_2(dataset)
    rates = {}
    for mode in ("paper", "repaired"):
        learned = learn(demonstrations, settings(mode, dataset, repeats=seeds, threshold=1.0))
        (score,) = [s for cluster in learned.clusters for s in cluster.scores if s.demonstration == "5"]
        rates[mode] = 1.0 - (score.stability or 0.0)
    return rates


def table_1(seed: int) -> tuple[dict[str, Trajectory], dict[str, Learned]]:
    """Learn experiment 1 in every mode: twelve demonstrations of 159 samples."""
    demonstrations = synthetic.experiment_1(seed)
    return demonstrations, {mode: learn(demonstrations, settings(mode, seed)) for mode in MODES}


def experiment_2(seed: int) -> tuple[dict[str, Trajectory], dict[str, Learned]]:
    """Learn experiment 2 in every mode: five demonstrations of 200 samples, the fifth wiggles."""
    demonstrations = synthetic.experiment_2(seed)
    return demonstrations, {mode: learn(demonstrations, settings(mode, seed)) for mode in MODES}


def rate(values: Sequence[bool]) -> Rate:
    return Rate(sum(values), len(values))


def settled(convergence: Sequence[float]) -> int:
    """Return the iteration from which the log-likelihood stays within 2 % of its end."""
    history = np.asarray(convergence)
    far = np.flatnonzero(np.abs(history - history[-1]) > 0.02 * abs(history[-1]))
    return int(far[-1]) + 2 if len(far) else 1


def course(learned: Learned, index: int) -> Array:
    """Return the learned path of a cluster as a polyline (400, 3) [m]."""
    path = next(path for path in learned.paths if path.cluster == index)
    return path.curve(np.linspace(0, 1, 400))


def strays(learned: Learned, index: int, demonstrations: dict[str, Trajectory]) -> tuple[float, float]:
    """Return how far a learned path is at most from the samples that it was learned from, and its end from any goal."""
    selected = [demonstrations[score.demonstration].positions for score in _of(learned, index).scores if score.selected]
    path = course(learned, index)
    away = cKDTree(np.concatenate(selected)).query(path)[0].max()
    return float(away), min(float(np.linalg.norm(positions[-1] - path[-1])) for positions in selected)


def _places(marked: set[str]) -> tuple[int, ...]:
    return tuple(sorted(map(int, marked)))


def _of(learned: Learned, index: int) -> Cluster:
    return next(cluster for cluster in learned.clusters if cluster.index == index)
