"""The consistent demonstrations of one cluster, by their likelihood under hidden Markov models."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from teachpath.learning.features import band_energies, positions_and_velocities
from teachpath.learning.hmm import MixtureHmm, TiedGaussianHmm
from teachpath.learning.settings import LearningSettings
from teachpath.records import Array, Cluster, Score, Trajectory

BAND_STATES = 5
COURSE_STATES = 20
FLOOR = 0.02  # share of the overall variance that a state's variance keeps at least
FOLDS = 10  # above THOROUGH members a model is trained per fold, not per member
THOROUGH = 30
USUAL_SPREAD = 1.0  # nats a frame, of the scores of demonstrations that are alike
BELIEF = 4  # members that the usual spread counts for beside the measured one
PAPER_RIDGE = 0.01  # squared codeword numbers, added to every covariance
PAPER_ITERATIONS = 10
FEW = 4  # members below which the ranking is unreliable

Tick = Callable[[], None]


@dataclass(frozen=True, eq=False)
class _Family:
    """One kind of feature of every member: what it tells, (frames, features) each, and the states of its models."""

    quality: str
    sequences: list[Array]
    states: int


def select(index: int, members: Mapping[str, Trajectory], settings: LearningSettings, *, tick: Tick) -> Cluster:
    """Rank the members of a cluster by consistency and keep all that are not inconsistent (mode default).

    Every member is scored by models trained on the others: a model cannot be lenient to what it never saw. The
    scores per frame of two kinds of features, band energies and positions with velocities, become robust z values;
    their sum, better than the median counting as the median, is the measure.

    Args:
        index: number of the cluster.
        members: id -> trajectory.
        settings: `keep` members are kept at least, and all above `inconsistent`, which is doubled for two or three
            members, for the spread of so few scores says little.
        tick: called once per model trained.
    """
    names = sorted(members)
    if len(names) == 1:
        return _whole(index, names, "one demonstration only: nothing to compare it with")
    trajectories = [members[name] for name in names]
    families = [_Family("course", positions_and_velocities(trajectories), COURSE_STATES)]
    bands = band_energies(trajectories, settings.period)
    notes = []
    if bands is None:
        notes.append("a demonstration is shorter than the analysis window: judged by positions and velocities only")
    else:
        families.append(_Family("smoothness", bands, BAND_STATES))
    if len(names) < FEW:
        notes.append(f"{len(names)} demonstrations: too few for a reliable ranking")
    profiles = [_left_out(family, tick) for family in families]
    scores = np.array([[profile.mean() for profile in row] for row in profiles])  # (families, m)
    z = np.stack([_robust_z(row) for row in scores])
    measure = np.minimum(z, 0.0).sum(axis=0)
    # Exact ties are common, for the median and the median deviation are members' own; rounding must not break them.
    order = np.lexsort((-scores.sum(axis=0), -np.round(z.sum(axis=0), 9), -np.round(measure, 9)))
    likelihoods = np.array([[profile.sum() for profile in row] for row in profiles]).sum(axis=0)
    limit = settings.inconsistent * (2 if len(names) < FEW else 1)
    kept = [rank < settings.keep or bool(measure[i] >= limit) for rank, i in enumerate(order)]
    ranked = []
    for rank, (i, keep) in enumerate(zip(order, kept, strict=True)):
        worst = int(np.argmin(z[:, i]))
        span = _worst_span(profiles[worst][i], trajectories[i])
        remark = f"inconsistent in its {families[worst].quality} (z {measure[i]:.1f}), most from {span}"
        note = remark if measure[i] < limit else ""
        ranked.append(Score(names[i], float(likelihoods[i]), rank + 1, keep, note))
    history = _fitted(families[0].sequences, families[0].states).history
    tick()
    return Cluster(index, tuple(score.demonstration for score in ranked), tuple(ranked), history, "; ".join(notes))


def select_as_paper(
    index: int,
    symbols: Mapping[str, Array],
    settings: LearningSettings,
    rng: np.random.Generator,
    *,
    tick: Tick,
) -> Cluster:
    """Train one model on all members, score them by it and keep the n best (Aleotti & Caselli, III-B.2).

    Args:
        index: number of the cluster.
        symbols: id -> (frames, 3) codeword numbers; frames may be 0 when a demonstration is shorter than the window.
        settings: `keep` members are kept; with fewer members selection is skipped.
        rng: draws the first Gaussians.
        tick: called once per model trained.
    """
    names = list(symbols)
    if len(names) < settings.keep:
        return _whole(index, names, f"selection skipped: fewer than {settings.keep} demonstrations")
    if any(len(sequence) == 0 for sequence in symbols.values()):
        return _whole(index, names, "selection skipped: a demonstration is shorter than the analysis window")
    model = MixtureHmm(
        settings.mixtures,
        PAPER_RIDGE,
        rng,
        states=settings.states,
        iterations=PAPER_ITERATIONS,
        tolerance=1e-4,
    )
    model.train(list(symbols.values()))
    tick()
    likelihoods = np.array([model.log_likelihood(sequence) for sequence in symbols.values()])
    ranked = tuple(
        Score(names[i], float(likelihoods[i]), rank + 1, rank < settings.keep)
        for rank, i in enumerate(np.argsort(-likelihoods, kind="stable"))
    )
    return Cluster(index, tuple(score.demonstration for score in ranked), ranked, model.history)


def models_to_train(sizes: Sequence[int]) -> int:
    """Return how often `select` ticks for clusters of these sizes."""
    return sum(0 if size == 1 else 2 * min(size, FOLDS if size > THOROUGH else size) + 1 for size in sizes)


def _whole(index: int, names: list[str], note: str) -> Cluster:
    scores = tuple(Score(name, 0.0, rank + 1, True, "not scored") for rank, name in enumerate(names))
    return Cluster(index, tuple(names), scores, (), note)


def _left_out(family: _Family, tick: Tick) -> list[Array]:
    """Return the log-likelihoods of every member's frames under a model of those outside its fold."""
    count = len(family.sequences)
    folds = np.arange(count) % (FOLDS if count > THOROUGH else count)
    profiles = [np.empty(0)] * count
    for fold in range(int(folds.max()) + 1):
        model = _fitted([family.sequences[i] for i in np.flatnonzero(folds != fold)], family.states)
        for i in np.flatnonzero(folds == fold):
            profiles[i] = model.log_likelihoods(family.sequences[i])
        tick()
    return profiles


def _fitted(sequences: list[Array], states: int) -> TiedGaussianHmm:
    pooled = np.concatenate(sequences)
    variance = pooled.var(axis=0)
    # A direction in which nothing moves must not weigh more than the others.
    floor = np.maximum(FLOOR * variance, 1e-3 * FLOOR * variance.max() + 1e-12)
    model = TiedGaussianHmm(floor, states=states, iterations=20)
    model.train(sequences)
    return model


def _robust_z(scores: Array) -> Array:
    """Return how many spreads a score is above the median; the spread is that of the median deviation, and believed
    only as far as the number of members goes.
    """
    offsets = scores - np.median(scores)
    measured = 1.4826 * float(np.median(np.abs(offsets)))
    count = len(scores)
    return np.asarray(offsets / np.sqrt((count * measured**2 + BELIEF * USUAL_SPREAD**2) / (count + BELIEF)))


def _worst_span(profile: Array, trajectory: Trajectory) -> str:
    """Say between which times the frames are at least half as unlikely as the unlikeliest."""
    deficit = np.median(profile) - profile
    low = np.append(np.flatnonzero(deficit < deficit.max() / 2), len(profile))
    worst = int(np.argmax(deficit))
    begin = int(np.max(low[low < worst], initial=-1)) + 1
    end = int(np.min(low[low > worst]))
    seconds = float(trajectory.times[-1] - trajectory.times[0]) / len(profile)
    return f"{begin * seconds:.1f} to {end * seconds:.1f} s"
