"""The consistent demonstrations of one cluster (mode default)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from teachpath.learning.selection.consistency import MODEL_STATES, ConsistencyScores, score_consistency
from teachpath.learning.selection.deviations import describe_deviation
from teachpath.learning.selection.features import Feature, FeatureSet, extract_features
from teachpath.learning.selection.gaussian_hmm import TrainingBudget, train_model
from teachpath.learning.selection.paper_mode import unscored
from teachpath.learning.settings import LearningSettings, StepCallback
from teachpath.records import Cluster, Deviation, Score, Trajectory

MIN_RELIABLE_MEMBERS = 4  # below which the ranking is unreliable
SMALL_CLUSTER_FACTOR = 1.5  # on the limit of z for so few members
MAX_LEAVE_ONE_OUT = 30  # members up to which each is scored by models of all others
MAX_FOLDS = 10  # above
REPETITION_FOLDS = 5
REPETITION_BUDGET = TrainingBudget(iterations=2, sequences=15)
MAX_COMPARED_MEMBERS = 50  # with which the words about a deviation compare
HOLDOUT_SHARE = 0.2  # of the members that a repetition leaves out, at least one

Ranking = list[tuple[int, bool]]  # member and whether it is selected, most consistent first


def select(
    index: int, members: Mapping[str, Trajectory], settings: LearningSettings, *, on_step: StepCallback
) -> Cluster:
    """Rank the members of a cluster by consistency and select all that are not inconsistent.

    `consistency.py` defines the measure. A member is inconsistent when its measure is below `settings.inconsistent`;
    with two or three members the limit is half as much again, because so few scores say little about their spread.

    Args:
        index: number of the cluster.
        members: id -> trajectory.
        settings: at least `keep` members are selected; `repeats` repetitions with other members left out count how
            stable the selection is.
        on_step: called after each trained model, and three times for each member.
    """
    names = sorted(members)
    if len(names) == 1:
        return unscored(index, names, "one demonstration only: nothing to compare it with")
    trajectories = [members[name] for name in names]
    features = extract_features(trajectories, settings.period, on_step)
    notes = []
    if Feature.SMOOTHNESS not in features:
        notes.append("a demonstration is shorter than the analysis window: judged by course, shape and bending only")
    if len(names) < MIN_RELIABLE_MEMBERS:
        notes.append(f"{len(names)} demonstrations: too few for a reliable ranking")
    everybody = range(len(names))
    consistency = score_consistency(features, everybody, _folds(len(names)), budget=TrainingBudget(), on_step=on_step)
    stabilities = _stabilities(features, len(names), settings, on_step)
    judged = _Judged(names, trajectories, features, consistency, _limit(len(names), settings))
    scores = []
    for rank, (i, selected) in enumerate(_ranking(consistency, settings)):
        scores.append(_score(judged, i, rank, selected, stabilities[i]))
        on_step()
    history = _convergence(features)
    on_step()
    return Cluster(index, tuple(score.demonstration for score in scores), tuple(scores), history, "; ".join(notes))


def step_count(sizes: Sequence[int], repeats: int) -> int:
    """Return how many steps `select` reports at most for clusters of these sizes."""
    total = 0
    for size in sizes:
        if size > 1:
            again = len(_holdouts(size, repeats, 0)) * (4 * min(size - 1, REPETITION_FOLDS) + 2)
            total += 4 * _folds(size) + 2 + again + 1 + 3 * size
    return total


@dataclass(frozen=True, eq=False)
class _Judged:
    """The members of a cluster with what is known of their consistency, and the limit of the measure."""

    names: Sequence[str]
    trajectories: Sequence[Trajectory]
    features: Mapping[Feature, FeatureSet]
    consistency: ConsistencyScores
    limit: float


def _folds(count: int) -> int:
    return MAX_FOLDS if count > MAX_LEAVE_ONE_OUT else count


def _limit(count: int, settings: LearningSettings) -> float:
    return settings.inconsistent * (SMALL_CLUSTER_FACTOR if count < MIN_RELIABLE_MEMBERS else 1)


def _ranking(consistency: ConsistencyScores, settings: LearningSettings) -> Ranking:
    limit = _limit(len(consistency.order), settings)
    return [
        (int(i), rank < settings.keep or bool(consistency.total[i] >= limit))
        for rank, i in enumerate(consistency.order)
    ]


def _holdouts(count: int, repeats: int, seed: int) -> list[set[int]]:
    """Return which members each repetition leaves out; of three or fewer members none can be spared."""
    if count < MIN_RELIABLE_MEMBERS:
        return []
    rng = np.random.default_rng(seed)
    size = max(1, round(HOLDOUT_SHARE * count))
    if size == 1:
        return [{int(i)} for i in rng.permutation(count)[:repeats]]
    return [{int(i) for i in rng.choice(count, size, replace=False)} for _ in range(repeats)]


def _stabilities(
    features: Mapping[Feature, FeatureSet], count: int, settings: LearningSettings, on_step: StepCallback
) -> list[float | None]:
    """Return for every member the share of the repetitions with it in which it is selected."""
    scored = np.zeros(count, dtype=int)
    selected = np.zeros(count, dtype=int)
    for holdout in _holdouts(count, settings.repeats, settings.seed):
        rest = [i for i in range(count) if i not in holdout]
        folds = min(len(rest), REPETITION_FOLDS)
        consistency = score_consistency(features, rest, folds, budget=REPETITION_BUDGET, on_step=on_step)
        for place, keep in _ranking(consistency, settings):
            scored[rest[place]] += 1
            selected[rest[place]] += keep
    return [float(k / n) if n else None for k, n in zip(selected, scored, strict=True)]


def _convergence(features: Mapping[Feature, FeatureSet]) -> tuple[float, ...]:
    """Return the log-likelihoods while a model of the course of all members is trained (Fig. 4)."""
    return train_model(features[Feature.COURSE].sequences, MODEL_STATES[Feature.COURSE], TrainingBudget()).history


def _score(judged: _Judged, i: int, rank: int, selected: bool, stability: float | None) -> Score:
    consistency = judged.consistency
    measure, order = consistency.total, consistency.order
    deviation, note = None, ""
    if measure[i] < judged.limit / 2:
        feature = _worst_feature(consistency, i, judged.limit)
        deviation = _deviation(judged, i, feature)
        if measure[i] < judged.limit:
            note = f"inconsistent in its {feature} (z {measure[i]:.1f}): {deviation.sentence}"
    likelihood = sum(float(row[i].sum()) for row in consistency.profiles.values())
    margin = float(measure[i] - measure[order[rank + 1]]) if rank + 1 < len(order) else None
    return Score(judged.names[i], likelihood, rank + 1, selected, note, margin, float(measure[i]), stability, deviation)


def _worst_feature(consistency: ConsistencyScores, i: int, limit: float) -> Feature:
    """Return the feature in which a member differs most.

    Shaking shows in course and shape too, but not the other way round, so the last feature goes first.
    """
    features = list(consistency.z)
    z = [float(of[i]) for of in consistency.z.values()]
    return features[-1] if z[-1] < limit else features[int(np.argmin(z))]


def _deviation(judged: _Judged, i: int, feature: Feature) -> Deviation:
    others = [trajectory for k, trajectory in enumerate(judged.trajectories) if k != i][:MAX_COMPARED_MEMBERS]
    profiles = judged.consistency.profiles[feature]
    usual = float(np.median(np.concatenate([profile for k, profile in enumerate(profiles) if k != i])))
    times = judged.features[feature].times[i]
    return describe_deviation(judged.trajectories[i], others, feature, profile=profiles[i], times=times, usual=usual)
