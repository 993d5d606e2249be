"""How consistent the members of a cluster are with one another.

Each member gets a robust z score for course, shape, smoothness and excess bending. Positive scores are clipped to 0;
the measure is their sum.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from teachpath.learning.selection.features import Feature, FeatureSet
from teachpath.learning.selection.gaussian_hmm import TrainingBudget, train_model
from teachpath.learning.selection.shape_residuals import score_bending
from teachpath.learning.settings import StepCallback
from teachpath.records import Array

MODEL_STATES = {Feature.COURSE: 10, Feature.SHAPE: 10, Feature.SMOOTHNESS: 5}  # of the hidden Markov models
MIN_MEMBERS_FOR_CORE = 4
PRIOR_SPREAD = 1.0  # nats a frame, usual spread of the scores of consistent demonstrations
PRIOR_MEMBERS = 4  # members that the usual spread counts for beside the measured one


@dataclass(frozen=True, eq=False)
class ConsistencyScores:
    """The scores of m members of a cluster.

    Attributes:
        profiles: for each feature and member the log-likelihoods of its frames.
        z: for each feature (m,) robust z scores; 0 = like the median member, negative = less consistent.
        total: (m,) sum over the features of the z scores, each clipped to at most 0.
        order: (m,) members from the most to the least consistent.
    """

    profiles: dict[Feature, list[Array]]
    z: dict[Feature, Array]
    total: Array
    order: NDArray[np.int64]


def score_consistency(
    features: Mapping[Feature, FeatureSet],
    members: Sequence[int],
    folds: int,
    *,
    budget: TrainingBudget,
    on_step: StepCallback,
) -> ConsistencyScores:
    """Score members of a cluster: course, shape, excess bending and, where it could be measured, smoothness.

    Course, shape and smoothness are scored by hidden Markov models of the other members, excess bending against the
    mean of the other members. Smoothness is scored a second time by models of the most consistent half (as in Hadi
    1992), and the lower z score counts: of five members, two that shake would otherwise excuse each other.

    Args:
        features: of all members of the cluster.
        members: which members take part.
        folds: number of parts into which the members are split; models of the other parts score a part. As many folds
            as members leave one member out at a time.
        budget: of the training of each model.
        on_step: called once per trained model, and once for the bending.
    """
    sequences = {feature: [of.sequences[i] for i in members] for feature, of in features.items()}
    profiles: dict[Feature, list[Array]] = {}
    z: dict[Feature, Array] = {}
    for feature, shown in sequences.items():
        if feature is Feature.BENDING:
            z[feature], rows = score_bending(np.stack(shown))
            profiles[feature] = list(rows)
            on_step()
        else:
            profiles[feature] = _cross_validate(feature, shown, range(len(members)), folds, budget, on_step)
            z[feature] = robust_z(_mean_frames(profiles[feature]))
    if Feature.SMOOTHNESS in sequences and len(members) >= MIN_MEMBERS_FOR_CORE:
        core = np.sort(_order(z, profiles)[: len(members) // 2 + 1])
        again = _cross_validate(Feature.SMOOTHNESS, sequences[Feature.SMOOTHNESS], core, folds, budget, on_step)
        profiles[Feature.SMOOTHNESS] = again
        z[Feature.SMOOTHNESS] = np.minimum(z[Feature.SMOOTHNESS], robust_z(_mean_frames(again), core))
    return ConsistencyScores(profiles, z, _total(z), _order(z, profiles))


def robust_z(scores: Array, core: NDArray[np.int64] | None = None) -> Array:
    """Return by how many spreads each score lies above the median.

    The spread follows from the median absolute deviation. For few members it is mixed with the usual spread, because
    the median absolute deviation of few scores is unreliable.

    Args:
        scores: (m,).
        core: members whose median and spread are taken; None = all.
    """
    known = scores if core is None else scores[core]
    measured = 1.4826 * float(np.median(np.abs(known - np.median(known))))
    spread = np.sqrt((len(known) * measured**2 + PRIOR_MEMBERS * PRIOR_SPREAD**2) / (len(known) + PRIOR_MEMBERS))
    return np.asarray((scores - np.median(known)) / spread)


def _cross_validate(
    feature: Feature,
    sequences: list[Array],
    core: Sequence[int] | NDArray[np.int64],
    folds: int,
    budget: TrainingBudget,
    on_step: StepCallback,
) -> list[Array]:
    """Return the profile of every sequence under a model of the core members, never of the sequence itself."""
    folds = min(folds, len(core))
    fold_of = np.full(len(sequences), folds)
    fold_of[core] = np.arange(len(core)) % folds
    profiles = [np.empty(0)] * len(sequences)
    for fold in range(folds + 1):
        scored = np.flatnonzero(fold_of == fold)
        if len(scored):
            model = train_model([sequences[i] for i in core if fold_of[i] != fold], MODEL_STATES[feature], budget)
            for i in scored:
                profiles[i] = model.log_likelihoods(sequences[i])
            on_step()
    return profiles


def _mean_frames(profiles: list[Array]) -> Array:
    return np.array([profile.mean() for profile in profiles])


def _total(z: Mapping[Feature, Array]) -> Array:
    return np.asarray(np.minimum(np.stack(list(z.values())), 0.0).sum(axis=0))


def _order(z: Mapping[Feature, Array], profiles: Mapping[Feature, list[Array]]) -> NDArray[np.int64]:
    """Rank by the measure, then by the unclipped sum of the z scores, then by likelihood."""
    likelihoods = np.sum([_mean_frames(row) for row in profiles.values()], axis=0)
    unclipped = np.stack(list(z.values())).sum(axis=0)
    # Exact ties are common, because the median and the median deviation are members' own; rounding must not break them.
    return np.lexsort((-likelihoods, -np.round(unclipped, 9), -np.round(_total(z), 9)))
