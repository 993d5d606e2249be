"""The consistent demonstrations of one cluster (mode default)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from teachpath.learning.selection.deviations import departure
from teachpath.learning.selection.features import Family, families
from teachpath.learning.selection.paper_mode import unscored
from teachpath.learning.selection.scoring import Effort, Judgement, fitted, judge
from teachpath.learning.settings import LearningSettings, Tick
from teachpath.records import Cluster, Score, Trajectory

FEW = 4  # members below which the ranking is unreliable
CAREFUL = 1.5  # factor on the limit for so few
FOLDS = 10  # above THOROUGH members a model is trained per fold, not per member
THOROUGH = 30
REPEATED_FOLDS = 5
REPEATED_EFFORT = Effort(iterations=2, sequences=15)
COMPARED = 50  # others at most that the words about a departure are found by
LEFT_OUT = 0.2  # share of the members that a repetition leaves out, at least one

Ranked = list[tuple[int, bool]]  # member and whether it is selected, most consistent first


def select(index: int, members: Mapping[str, Trajectory], settings: LearningSettings, *, tick: Tick) -> Cluster:
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
        tick: called after each model trained, and three times for each member.
    """
    names = sorted(members)
    if len(names) == 1:
        return unscored(index, names, "one demonstration only: nothing to compare it with")
    trajectories = [members[name] for name in names]
    kinds = families(trajectories, settings.period, tick)
    notes = []
    if kinds[-1].quality != "smoothness":
        notes.append("a demonstration is shorter than the analysis window: judged by course, shape and bends only")
    if len(names) < FEW:
        notes.append(f"{len(names)} demonstrations: too few for a reliable ranking")
    judgement = judge(kinds, range(len(names)), _folds(len(names)), effort=Effort(), tick=tick)
    stabilities = _stabilities(kinds, len(names), settings, tick)
    limit = _limit(len(names), settings)
    scores = []
    for rank, (i, keep) in enumerate(_ranked(judgement, settings)):
        scores.append(_score(names[i], i, rank, keep, judgement, stabilities, limit, kinds, trajectories))
        tick()
    history = fitted(kinds[0].sequences, kinds[0].states, Effort()).history
    tick()
    return Cluster(index, tuple(score.demonstration for score in scores), tuple(scores), history, "; ".join(notes))


def pieces_of_work(sizes: Sequence[int], repeats: int) -> int:
    """Return how often `select` ticks at most for clusters of these sizes."""
    total = 0
    for size in sizes:
        if size > 1:
            again = len(_drops(size, repeats, 0)) * (4 * min(size - 1, REPEATED_FOLDS) + 2)
            total += 4 * _folds(size) + 2 + again + 1 + 3 * size
    return total


def _folds(count: int) -> int:
    return FOLDS if count > THOROUGH else count


def _limit(count: int, settings: LearningSettings) -> float:
    return settings.inconsistent * (CAREFUL if count < FEW else 1)


def _ranked(judgement: Judgement, settings: LearningSettings) -> Ranked:
    limit = _limit(len(judgement.order), settings)
    return [
        (int(i), rank < settings.keep or bool(judgement.measure[i] >= limit)) for rank, i in enumerate(judgement.order)
    ]


def _drops(count: int, repeats: int, seed: int) -> list[set[int]]:
    """Return which members each repetition leaves out; nobody can be missed among three."""
    if count < FEW:
        return []
    rng = np.random.default_rng(seed)
    size = max(1, round(LEFT_OUT * count))
    if size == 1:
        return [{int(i)} for i in rng.permutation(count)[:repeats]]
    return [{int(i) for i in rng.choice(count, size, replace=False)} for _ in range(repeats)]


def _stabilities(kinds: Sequence[Family], count: int, settings: LearningSettings, tick: Tick) -> list[float | None]:
    """Return for every member the share of repetitions with it in which it is selected."""
    taken, kept = np.zeros(count, dtype=int), np.zeros(count, dtype=int)
    for dropped in _drops(count, settings.repeats, settings.seed):
        rest = [i for i in range(count) if i not in dropped]
        folds = min(len(rest), REPEATED_FOLDS)
        judgement = judge(kinds, rest, folds, effort=REPEATED_EFFORT, tick=tick)
        for place, keep in _ranked(judgement, settings):
            taken[rest[place]] += 1
            kept[rest[place]] += keep
    return [float(k / n) if n else None for k, n in zip(kept, taken, strict=True)]


def _score(
    name: str,
    i: int,
    rank: int,
    keep: bool,
    judgement: Judgement,
    stabilities: Sequence[float | None],
    limit: float,
    kinds: Sequence[Family],
    trajectories: Sequence[Trajectory],
) -> Score:
    measure, order = judgement.measure, judgement.order
    found, note = None, ""
    if measure[i] < limit / 2:
        # Shaking shows in course and shape too, but not the other way round.
        worst = -1 if judgement.z[-1, i] < limit else int(np.argmin(judgement.z[:, i]))
        others = [trajectory for k, trajectory in enumerate(trajectories) if k != i][:COMPARED]
        profiles = judgement.profiles[worst]
        usual = float(np.median(np.concatenate([profile for k, profile in enumerate(profiles) if k != i])))
        kind = kinds[worst]
        found = departure(trajectories[i], others, kind.quality, profile=profiles[i], times=kind.times[i], usual=usual)
        if measure[i] < limit:
            note = f"inconsistent in its {kind.quality} (z {measure[i]:.1f}): {found.sentence}"
    likelihood = sum(float(row[i].sum()) for row in judgement.profiles)
    margin = float(measure[i] - measure[order[rank + 1]]) if rank + 1 < len(order) else None
    return Score(name, likelihood, rank + 1, keep, note, margin, float(measure[i]), stabilities[i], found)
