"""The consistent demonstrations of one cluster (mode default)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from teachpath.learning.selection.deviations import describe_deviation
from teachpath.learning.selection.features import FeatureSet, extract_features
from teachpath.learning.selection.paper_mode import unscored
from teachpath.learning.selection.scoring import ConsistencyScores, TrainingBudget, score_consistency, train_model
from teachpath.learning.settings import LearningSettings, StepCallback
from teachpath.records import Cluster, Score, Trajectory

MIN_RELIABLE_MEMBERS = 4  # members below which the ranking is unreliable
SMALL_CLUSTER_FACTOR = 1.5  # factor on the limit for so few
MAX_FOLDS = 10  # above THOROUGH members a model is trained per fold, not per member
MAX_LEAVE_ONE_OUT = 30
REPETITION_FOLDS = 5
REPETITION_BUDGET = TrainingBudget(iterations=2, sequences=15)
MAX_COMPARED_MEMBERS = 50  # others at most that the words about a departure are found by
HOLDOUT_SHARE = 0.2  # share of the members that a repetition leaves out, at least one

Ranking = list[tuple[int, bool]]  # member and whether it is selected, most consistent first


def select(
    index: int, members: Mapping[str, Trajectory], settings: LearningSettings, *, on_step: StepCallback
) -> Cluster:
    """Rank the members of a cluster by consistency and keep all that are not inconsistent.

    Every member is scored by models trained on the others: a model cannot be lenient to what it never saw; in their
    smoothness also by models of the better half, so that two that shake do not excuse each other. The
    scores per frame of three kinds of features, course, shape and smoothness, become robust z values, and so does what
    its bends have that those of the others have not; their sum, better than the median counting as the median, is the
    measure.

    Args:
        index: number of the cluster.
        members: id -> trajectory.
        settings: `keep` members are kept at least, and all above `inconsistent`, which is half as much again for two
            or three members, for the spread of so few scores says little; `repeats` is for the stability.
        on_step: called after each model trained, and three times for each member.
    """
    names = sorted(members)
    if len(names) == 1:
        return unscored(index, names, "one demonstration only: nothing to compare it with")
    trajectories = [members[name] for name in names]
    kinds = extract_features(trajectories, settings.period, on_step)
    notes = []
    if kinds[-1].kind != "smoothness":
        notes.append("a demonstration is shorter than the analysis window: judged by course, shape and bends only")
    if len(names) < MIN_RELIABLE_MEMBERS:
        notes.append(f"{len(names)} demonstrations: too few for a reliable ranking")
    judgement = score_consistency(
        kinds, range(len(names)), _folds(len(names)), effort=TrainingBudget(), on_step=on_step
    )
    stabilities = _stabilities(kinds, len(names), settings, on_step)
    limit = _limit(len(names), settings)
    scores = []
    for rank, (i, keep) in enumerate(_ranked(judgement, settings)):
        scores.append(_score(names[i], i, rank, keep, judgement, stabilities, limit, kinds, trajectories))
        on_step()
    history = train_model(kinds[0].sequences, kinds[0].states, TrainingBudget()).history
    on_step()
    return Cluster(index, tuple(score.demonstration for score in scores), tuple(scores), history, "; ".join(notes))


def step_count(sizes: Sequence[int], repeats: int) -> int:
    """Return how often `select` ticks at most for clusters of these sizes."""
    total = 0
    for size in sizes:
        if size > 1:
            again = len(_drops(size, repeats, 0)) * (4 * min(size - 1, REPETITION_FOLDS) + 2)
            total += 4 * _folds(size) + 2 + again + 1 + 3 * size
    return total


def _folds(count: int) -> int:
    return MAX_FOLDS if count > MAX_LEAVE_ONE_OUT else count


def _limit(count: int, settings: LearningSettings) -> float:
    return settings.inconsistent * (SMALL_CLUSTER_FACTOR if count < MIN_RELIABLE_MEMBERS else 1)


def _ranked(judgement: ConsistencyScores, settings: LearningSettings) -> Ranking:
    limit = _limit(len(judgement.order), settings)
    return [
        (int(i), rank < settings.keep or bool(judgement.total[i] >= limit)) for rank, i in enumerate(judgement.order)
    ]


def _drops(count: int, repeats: int, seed: int) -> list[set[int]]:
    """Return which members each repetition leaves out; nobody can be missed among three."""
    if count < MIN_RELIABLE_MEMBERS:
        return []
    rng = np.random.default_rng(seed)
    size = max(1, round(HOLDOUT_SHARE * count))
    if size == 1:
        return [{int(i)} for i in rng.permutation(count)[:repeats]]
    return [{int(i) for i in rng.choice(count, size, replace=False)} for _ in range(repeats)]


def _stabilities(
    kinds: Sequence[FeatureSet], count: int, settings: LearningSettings, on_step: StepCallback
) -> list[float | None]:
    """Return for every member the share of repetitions with it in which it is selected."""
    taken, kept = np.zeros(count, dtype=int), np.zeros(count, dtype=int)
    for dropped in _drops(count, settings.repeats, settings.seed):
        rest = [i for i in range(count) if i not in dropped]
        folds = min(len(rest), REPETITION_FOLDS)
        judgement = score_consistency(kinds, rest, folds, effort=REPETITION_BUDGET, on_step=on_step)
        for place, keep in _ranked(judgement, settings):
            taken[rest[place]] += 1
            kept[rest[place]] += keep
    return [float(k / n) if n else None for k, n in zip(kept, taken, strict=True)]


def _score(
    name: str,
    i: int,
    rank: int,
    keep: bool,
    judgement: ConsistencyScores,
    stabilities: Sequence[float | None],
    limit: float,
    kinds: Sequence[FeatureSet],
    trajectories: Sequence[Trajectory],
) -> Score:
    measure, order = judgement.total, judgement.order
    found, note = None, ""
    if measure[i] < limit / 2:
        # Shaking shows in course and shape too, but not the other way round.
        worst = -1 if judgement.z[-1, i] < limit else int(np.argmin(judgement.z[:, i]))
        others = [trajectory for k, trajectory in enumerate(trajectories) if k != i][:MAX_COMPARED_MEMBERS]
        profiles = judgement.profiles[worst]
        usual = float(np.median(np.concatenate([profile for k, profile in enumerate(profiles) if k != i])))
        kind = kinds[worst]
        found = describe_deviation(
            trajectories[i], others, kind.kind, profile=profiles[i], times=kind.times[i], usual=usual
        )
        if measure[i] < limit:
            note = f"inconsistent in its {kind.kind} (z {measure[i]:.1f}): {found.sentence}"
    likelihood = sum(float(row[i].sum()) for row in judgement.profiles)
    margin = float(measure[i] - measure[order[rank + 1]]) if rank + 1 < len(order) else None
    return Score(name, likelihood, rank + 1, keep, note, margin, float(measure[i]), stabilities[i], found)
