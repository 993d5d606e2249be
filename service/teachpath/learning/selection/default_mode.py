"""The consistent demonstrations of one cluster (mode default)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from teachpath.learning.resampling import at_equal_arc_length, at_equal_times, extent
from teachpath.learning.selection.consistency import FAULT_OF_FEATURE, Measures, Part, measure, others_median
from teachpath.learning.selection.deviations import PATH_POINTS, ComparedMembers, describe_deviation, describe_pace
from teachpath.learning.selection.features import MotionFeatures, extract_features, positions_and_velocities
from teachpath.learning.selection.likelihoods import convergence, fold_count, score_likelihoods
from teachpath.learning.selection.paper_mode import unscored
from teachpath.learning.settings import LearningSettings, StepCallback
from teachpath.lengths import describe_length
from teachpath.records import Array, Cluster, Score, Trajectory

MIN_RELIABLE_MEMBERS = 4  # below which the ranking is unreliable
SMALL_CLUSTER_FACTOR = 1.5  # on the limit of z for so few members
BENDING_POINTS = 100  # equal times at which a course is sampled for its bending
MAX_COMPARED_MEMBERS = 50  # with which one is compared in words
REPORTED_SHARE = 2 / 3  # of the limit, from which on the deviation of a selected member is reported
HOLDOUT_SHARE = 0.2  # of the members that a repetition leaves out, at least one


def select(
    index: int, members: Mapping[str, Trajectory], settings: LearningSettings, *, on_step: StepCallback
) -> Cluster:
    """Rank the members of a cluster by consistency and select all that are not inconsistent.

    `consistency.py` defines the measure. A member is inconsistent when it is worse than the others by more than
    `settings.outlier_limit`; with two or three members the limit is half as much again, because so few scores say
    little about their spread. Hidden Markov models judge nothing here: their log-likelihoods are reported.

    Args:
        index: number of the cluster.
        members: id -> trajectory.
        settings: at least `keep` members are selected; `repeats` repetitions with other members left out count how
            stable the selection is.
        on_step: called twice for each member, and after each trained model.
    """
    names = sorted(members)
    if len(names) == 1:
        return unscored(index, names, "one demonstration only: nothing to compare it with")
    trajectories = [members[name] for name in names]
    features, measures = measure_members(trajectories, settings, on_step)
    sequences = positions_and_velocities(trajectories, [of.path for of in features])
    likelihoods = score_likelihoods(sequences, on_step=on_step)
    selection = _judge(measures, np.arange(len(names)), settings)
    stabilities = _stabilities(measures, len(names), settings)
    found = _described(names, trajectories, features, measures.shaking, selection)
    scores = []
    for rank, i in enumerate(selection.order):
        scores.append(_score(found, int(i), rank, float(likelihoods[i]), stabilities[i]))
        on_step()
    history = convergence(sequences)
    on_step()
    few = f"{len(names)} demonstrations: too few for a reliable ranking" if len(names) < MIN_RELIABLE_MEMBERS else ""
    return Cluster(index, tuple(score.demonstration for score in scores), tuple(scores), history, few)


def measure_members(
    trajectories: Sequence[Trajectory], settings: LearningSettings, on_step: StepCallback = lambda: None
) -> tuple[list[MotionFeatures], Measures]:
    """Measure the members of a cluster; `on_step` is called once for each."""
    features = []
    for trajectory in trajectories:
        features.append(extract_features(trajectory))
        on_step()
    size = max(float(np.median([extent(of.path) for of in features])), 1e-9)
    courses = [at_equal_times(t, BENDING_POINTS, of.path) for t, of in zip(trajectories, features, strict=True)]
    return features, measure(features, np.stack(courses), size, settings.bound_for(size))


def step_count(sizes: Sequence[int]) -> int:
    """Return how many steps `select` reports for clusters of these sizes."""
    return sum(2 * size + fold_count(size) + 1 for size in sizes if size > 1)


@dataclass(frozen=True, eq=False)
class Selection:
    """Which of m members are selected.

    Attributes:
        z: for each part of the measure (m,).
        worst: (m,) largest of them.
        order: (m,) members from the most to the least consistent.
        selected: (m,).
        limit: of the worst score.
    """

    z: dict[Part, Array]
    worst: Array
    order: NDArray[np.int64]
    selected: NDArray[np.bool_]
    limit: float


@dataclass(frozen=True, eq=False)
class _Members:
    """The members of a cluster with what is known of them."""

    names: Sequence[str]
    trajectories: Sequence[Trajectory]
    features: Sequence[MotionFeatures]
    selection: Selection
    durations: Array  # (m,) [s] median of the others
    measured: ComparedMembers
    mean: Array  # (100, 3) [m] of the paths of the selected


def _described(
    names: Sequence[str],
    trajectories: Sequence[Trajectory],
    features: Sequence[MotionFeatures],
    shaking: Array,
    selection: Selection,
) -> _Members:
    courses = np.stack([at_equal_arc_length(of.path, PATH_POINTS) for of in features])
    durations = np.array([of.duration for of in features])
    passing = np.stack([of.passing for of in features])
    measured = ComparedMembers(np.diff(passing, axis=1) / durations[:, None], courses, shaking)
    mean = courses[selection.selected].mean(axis=0)
    return _Members(names, trajectories, features, selection, others_median(durations)[0], measured, mean)


def _judge(measures: Measures, at: NDArray[np.int64], settings: LearningSettings) -> Selection:
    """Judge the members `at` by one another."""
    z = measures.scores(at)
    worst = np.max(list(z.values()), axis=0)
    limit = settings.outlier_limit * (SMALL_CLUSTER_FACTOR if len(at) < MIN_RELIABLE_MEMBERS else 1)
    order = np.argsort(np.round(worst, 9), kind="stable")  # rounding must not rank members that are alike
    selected = worst <= limit
    selected[order[: settings.keep]] = True
    return Selection(z, worst, order, selected, limit)


def _holdouts(count: int, repeats: int, seed: int) -> list[set[int]]:
    """Return which members each repetition leaves out; of three or fewer members none can be spared."""
    if count < MIN_RELIABLE_MEMBERS:
        return []
    rng = np.random.default_rng(seed)
    size = max(1, round(HOLDOUT_SHARE * count))
    if size == 1:
        return [{int(i)} for i in rng.permutation(count)[:repeats]]
    return [{int(i) for i in rng.choice(count, size, replace=False)} for _ in range(repeats)]


def _stabilities(measures: Measures, count: int, settings: LearningSettings) -> list[float | None]:
    """Return for every member the share of the repetitions with it in which it is selected."""
    scored = np.zeros(count, dtype=int)
    selected = np.zeros(count, dtype=int)
    for holdout in _holdouts(count, settings.repeats, settings.seed):
        rest = np.array([i for i in range(count) if i not in holdout])
        scored[rest] += 1
        selected[rest] += _judge(measures, rest, settings).selected
    return [float(k / n) if n else None for k, n in zip(selected, scored, strict=True)]


def _score(cluster: _Members, i: int, rank: int, likelihood: float, stability: float | None) -> Score:
    selection = cluster.selection
    measure, order, limit = np.minimum(-selection.worst, 0.0), selection.order, selection.limit
    deviation, note = None, ""
    if selection.worst[i] > REPORTED_SHARE * limit:
        part = _worst_part(selection, i)
        deviation = describe_deviation(cluster.trajectories[i], cluster.features[i], _others(cluster.measured, i), part)
        if not selection.selected[i]:
            fault = f"inconsistent in its {FAULT_OF_FEATURE[part]} (z {measure[i]:.1f})"
            note = f"{fault}: {deviation.sentence}; {_cost(cluster, i)}"
    else:
        deviation = describe_pace(cluster.features[i].duration, float(cluster.durations[i]))
    margin = float(measure[i] - measure[order[rank + 1]]) if rank + 1 < len(order) else None
    return Score(
        cluster.names[i],
        likelihood,
        rank + 1,
        bool(selection.selected[i]),
        note,
        margin,
        float(measure[i]),
        stability,
        deviation,
    )


def _worst_part(selection: Selection, i: int) -> Part:
    """Return the part that tells best what is wrong with member i, where one fault shows in several."""
    z = {part: float(scores[i]) for part, scores in selection.z.items()}
    if z[Part.FREEZE] > selection.limit:
        return Part.FREEZE  # its leap shakes and pauses as well
    z[Part.JUMP] /= 2  # a hand that trembles jumps as well
    z[Part.DETOUR] /= 2  # and turns aside
    worst = max(z, key=lambda part: z[part])
    bends = worst in (Part.BEND, Part.DETOUR)
    return Part.PAUSE if bends and z[Part.PAUSE] > selection.limit else worst


def _others(measured: ComparedMembers, i: int) -> ComparedMembers:
    """Return those that member i is compared with in words."""
    others = [k for k in range(len(measured.courses)) if k != i][:MAX_COMPARED_MEMBERS]
    return ComparedMembers(measured.durations[others], measured.courses[others], measured.shaking[others])


def _cost(cluster: _Members, i: int) -> str:
    """Say how far the mean of the selected members moves without one that is left out."""
    apart = np.linalg.norm(cluster.measured.courses[i] - cluster.mean, axis=1)
    moved = float(apart.max()) / (int(cluster.selection.selected.sum()) + 1)
    return f"without it the path moves by up to {describe_length(moved)}"
