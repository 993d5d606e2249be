"""How consistent demonstrations are with one another: likelihoods under models of the others, as robust z scores."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from teachpath.learning.features import Family
from teachpath.learning.hmm import TiedGaussianHmm
from teachpath.records import Array

FLOOR = 0.02  # share of the overall variance that a state's variance keeps at least
USUAL_SPREAD = 1.0  # nats a frame, of the scores of demonstrations that are alike
BELIEF = 4  # members that the usual spread counts for beside the measured one

Tick = Callable[[], None]


@dataclass(frozen=True, eq=False)
class Judgement:
    """What the members of a cluster score.

    Attributes:
        profiles: for each family and member the log-likelihoods of its frames.
        z: (families, m) robust z scores of their means.
        measure: (m,) sum of the z scores, those above the median counting as the median: 0 or less.
        order: (m,) members from the most to the least consistent.
    """

    profiles: list[list[Array]]
    z: Array
    measure: Array
    order: NDArray[np.int64]


@dataclass(frozen=True)
class Effort:
    """What the training of one model may cost: iterations of Baum-Welch, and sequences; more do not make it better."""

    iterations: int = 8
    sequences: int = 30


def judge(families: Sequence[Family], members: Sequence[int], folds: int, *, effort: Effort, tick: Tick) -> Judgement:
    """Score members by models that were trained on the others.

    Args:
        families: the features of all members of the cluster.
        members: which of them take part.
        folds: parts of which each is scored by models of the other parts; as many as members = leave one out.
        effort: for each model.
        tick: called once per model trained.
    """
    profiles = []
    for family in families:
        sequences = [family.sequences[i] for i in members]
        profiles.append(_left_out(sequences, family.states, folds, effort, tick))
    scores = np.array([[profile.mean() for profile in row] for row in profiles])
    z = np.stack([robust_z(row) for row in scores])
    measure = np.minimum(z, 0.0).sum(axis=0)
    # Exact ties are common, for the median and the median deviation are members' own; rounding must not break them.
    order = np.lexsort((-scores.sum(axis=0), -np.round(z.sum(axis=0), 9), -np.round(measure, 9)))
    return Judgement(profiles, z, measure, order)


def fitted(sequences: Sequence[Array], states: int, effort: Effort) -> TiedGaussianHmm:
    """Return a model of sequences (frames, features), of too many only some at equal steps."""
    if len(sequences) > effort.sequences:
        sequences = [sequences[i] for i in np.linspace(0, len(sequences) - 1, effort.sequences).astype(int)]
    variance = np.concatenate(sequences).var(axis=0)
    # A direction in which nothing moves must not weigh more than the others.
    floor = np.maximum(FLOOR * variance, 1e-3 * FLOOR * variance.max() + 1e-12)
    model = TiedGaussianHmm(floor, states=states, iterations=effort.iterations)
    model.train(sequences)
    model.widen(len(sequences))
    return model


def robust_z(scores: Array) -> Array:
    """Return how many spreads a score is above the median; the spread is that of the median deviation, and believed
    only as far as the number of members goes.
    """
    offsets = scores - np.median(scores)
    measured = 1.4826 * float(np.median(np.abs(offsets)))
    count = len(scores)
    return np.asarray(offsets / np.sqrt((count * measured**2 + BELIEF * USUAL_SPREAD**2) / (count + BELIEF)))


def _left_out(sequences: list[Array], states: int, folds: int, effort: Effort, tick: Tick) -> list[Array]:
    part = np.arange(len(sequences)) % folds
    profiles = [np.empty(0)] * len(sequences)
    for fold in range(folds):
        model = fitted([sequences[i] for i in np.flatnonzero(part != fold)], states, effort)
        for i in np.flatnonzero(part == fold):
            profiles[i] = model.log_likelihoods(sequences[i])
        tick()
    return profiles
