"""How consistent demonstrations are with one another: likelihoods under models of the others, as robust z scores."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from teachpath.learning.selection.features import FeatureSet
from teachpath.learning.selection.gaussian_hmm import TiedGaussianHmm
from teachpath.learning.selection.shape_residuals import score_bending
from teachpath.learning.settings import StepCallback
from teachpath.records import Array

VARIANCE_FLOOR_SHARE = 0.02  # share of the overall variance that a state's variance keeps at least
PRIOR_SPREAD = 1.0  # nats a frame, of the scores of demonstrations that are alike
MIN_MEMBERS_FOR_CORE = 4  # members
PRIOR_MEMBERS = 4  # members that the usual spread counts for beside the measured one


@dataclass(frozen=True, eq=False)
class ConsistencyScores:
    """What the members of a cluster score.

    Attributes:
        profiles: for each family and member the log-likelihoods of its frames.
        z: (families, m) robust z scores of their means.
        total: (m,) sum of the z scores, those above the median counting as the median: 0 or less.
        order: (m,) members from the most to the least consistent.
    """

    profiles: list[list[Array]]
    z: Array
    total: Array
    order: NDArray[np.int64]


@dataclass(frozen=True)
class TrainingBudget:
    """What the training of one model may cost: iterations of Baum-Welch, and sequences; more do not make it better."""

    iterations: int = 8
    sequences: int = 30


def score_consistency(
    families: Sequence[FeatureSet], members: Sequence[int], folds: int, *, effort: TrainingBudget, on_step: StepCallback
) -> ConsistencyScores:
    """Score members by models that were trained on the others.

    In families in which all are alike, they are scored once more by models of the better half, and the worse of the two
    z scores counts: the members that agree best judge the rest (as in Hadi 1992).

    Args:
        families: the features of all members of the cluster.
        members: which of them take part.
        folds: parts of which each is scored by models of the other parts; as many as members = leave one out.
        effort: for each model.
        on_step: called once per model trained, and once for the bends.
    """
    profiles, rows = [], []
    for family in families:
        sequences = [family.sequences[i] for i in members]
        if family.states == 0:
            row, profile = score_bending(np.stack(sequences))
            profiles.append(list(profile))
            on_step()
        else:
            profiles.append(_left_out(sequences, range(len(members)), family.states, folds, effort, on_step))
            row = robust_z(_means(profiles[-1]))
        rows.append(row)
    z = np.stack(rows)
    if len(members) >= MIN_MEMBERS_FOR_CORE:
        # Spoilt in the same way, two of five lend each other a model; those that agree best lend them none.
        core = np.sort(_order(z, profiles)[: len(members) // 2 + 1])
        for k, family in enumerate(families):
            if family.core_scored:
                sequences = [family.sequences[i] for i in members]
                profiles[k] = _left_out(sequences, core, family.states, folds, effort, on_step)
                z[k] = np.minimum(z[k], robust_z(_means(profiles[k]), core))
    return ConsistencyScores(profiles, z, np.minimum(z, 0.0).sum(axis=0), _order(z, profiles))


def _order(z: Array, profiles: list[list[Array]]) -> NDArray[np.int64]:
    scores = np.sum([_means(row) for row in profiles], axis=0)
    # Exact ties are common, for the median and the median deviation are members' own; rounding must not break them.
    return np.lexsort((-scores, -np.round(z.sum(axis=0), 9), -np.round(np.minimum(z, 0.0).sum(axis=0), 9)))


def _means(profiles: list[Array]) -> Array:
    return np.array([profile.mean() for profile in profiles])


def train_model(sequences: Sequence[Array], states: int, effort: TrainingBudget) -> TiedGaussianHmm:
    """Return a model of sequences (frames, features), of too many only some at equal steps."""
    if len(sequences) > effort.sequences:
        sequences = [sequences[i] for i in np.linspace(0, len(sequences) - 1, effort.sequences).astype(int)]
    variance = np.concatenate(sequences).var(axis=0)
    # A direction in which nothing moves must not weigh more than the others.
    floor = np.maximum(VARIANCE_FLOOR_SHARE * variance, 1e-3 * VARIANCE_FLOOR_SHARE * variance.max() + 1e-12)
    model = TiedGaussianHmm(floor, states=states, iterations=effort.iterations)
    model.train(sequences)
    model.widen(len(sequences))
    return model


def robust_z(scores: Array, core: NDArray[np.int64] | None = None) -> Array:
    """Return how many spreads a score is above the median; the spread is that of the median deviation, and believed
    only as far as the number of members goes.

    Args:
        scores: (m,).
        core: whose median and spread are taken; None = everybody's.
    """
    known = scores if core is None else scores[core]
    measured = 1.4826 * float(np.median(np.abs(known - np.median(known))))
    spread = np.sqrt((len(known) * measured**2 + PRIOR_MEMBERS * PRIOR_SPREAD**2) / (len(known) + PRIOR_MEMBERS))
    return np.asarray((scores - np.median(known)) / spread)


def _left_out(
    sequences: list[Array],
    core: Sequence[int] | NDArray[np.int64],
    states: int,
    folds: int,
    effort: TrainingBudget,
    on_step: StepCallback,
) -> list[Array]:
    """Return the profile of each sequence under a model of the core, without itself where it belongs to the core."""
    folds = min(folds, len(core))
    part = np.full(len(sequences), folds)
    part[core] = np.arange(len(core)) % folds
    profiles = [np.empty(0)] * len(sequences)
    for fold in range(folds + 1):
        scored = np.flatnonzero(part == fold)
        if len(scored):
            model = train_model([sequences[i] for i in core if part[i] != fold], states, effort)
            for i in scored:
                profiles[i] = model.log_likelihoods(sequences[i])
            on_step()
    return profiles
