"""Selection as Aleotti & Caselli 2005 describe it, and mode repaired, which mends what leads to random choices.

Symbols are codeword numbers of short-time spectra; one hidden Markov model is trained on all members of a cluster,
which are then scored by it (section III-B).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from teachpath.learning.selection.mixture_hmm import MixtureHmm
from teachpath.learning.selection.symbols import WINDOW, spectra, symbol_sequences
from teachpath.learning.settings import LearningSettings, StepCallback
from teachpath.records import Array, Cluster, Score

RIDGE = 0.01  # squared codeword numbers, added to every covariance
ITERATIONS = 10
TOLERANCE = 1e-4
PRIOR_SPREAD = 1.0  # nats a frame, usual spread of the scores of consistent demonstrations
PRIOR_MEMBERS = 4  # members that the usual spread counts for beside the measured one
REPAIRED_STATES, REPAIRED_MIXTURES = 5, 1


def select_as_paper(
    equalised: Mapping[str, Array],
    members: Sequence[Sequence[str]],
    settings: LearningSettings,
    *,
    on_step: StepCallback,
) -> tuple[Cluster, ...]:
    """Score the members of every cluster by the cluster's own model and keep the n best.

    Mode repaired numbers the codewords in the order of their first principal component, starts the states from slices
    of time, and has fewer states with one Gaussian each. With `repeats`, everything is repeated with other seeds, which
    gives the stability.

    Args:
        equalised: id -> positions (n, 3) [m], all of one length.
        members: the members of every cluster.
        settings: the `keep` best members are selected; with fewer members selection is skipped.
        on_step: called once per model trained.
    """
    shortest = min(len(positions) for positions in equalised.values())
    if shortest < WINDOW:
        note = "selection skipped: a demonstration is shorter than the analysis window"
        return tuple(unscored(index + 1, ids, note) for index, ids in enumerate(members))
    names = sorted(equalised)
    all_spectra = [spectra(equalised[name]) for name in names]
    first = _once(names, all_spectra, members, settings, np.random.default_rng(settings.seed), on_step)
    kept = dict.fromkeys(equalised, 0)
    for repeat in range(settings.repeats):
        rng = np.random.default_rng([settings.seed, repeat + 1])
        for cluster in _once(names, all_spectra, members, settings, rng, on_step):
            for score in cluster.scores:
                kept[score.demonstration] += score.selected
    if settings.repeats == 0:
        return first
    return tuple(
        replace(cluster, scores=tuple(_with_stability(score, kept, settings.repeats) for score in cluster.scores))
        for cluster in first
    )


def unscored(index: int, names: Sequence[str], note: str) -> Cluster:
    """Return a cluster whose members are all selected without a score; the note says why."""
    scores = tuple(Score(name, 0.0, rank + 1, True, "not scored") for rank, name in enumerate(names))
    return Cluster(index, tuple(names), scores, (), note)


def paper_step_count(clusters: int, repeats: int) -> int:
    """Return how many steps `select_as_paper` reports."""
    return clusters * (1 + repeats)


def _once(
    names: list[str],
    all_spectra: list[Array],
    members: Sequence[Sequence[str]],
    settings: LearningSettings,
    rng: np.random.Generator,
    on_step: StepCallback,
) -> tuple[Cluster, ...]:
    sequences = symbol_sequences(all_spectra, settings.codebook, rng, ordered=settings.mode == "repaired")
    symbols = dict(zip(names, sequences, strict=True))
    clusters = []
    for index, ids in enumerate(members):
        clusters.append(_selected(index + 1, {name: symbols[name] for name in sorted(ids)}, settings, rng))
        on_step()
    return tuple(clusters)


def _selected(
    index: int, symbols: Mapping[str, Array], settings: LearningSettings, rng: np.random.Generator
) -> Cluster:
    names = list(symbols)
    if len(names) < settings.keep:
        return unscored(index, names, f"selection skipped: fewer than {settings.keep} demonstrations")
    repaired = settings.mode == "repaired"
    model = MixtureHmm(
        REPAIRED_MIXTURES if repaired else settings.mixtures,
        RIDGE,
        rng,
        time_sliced=repaired,
        states=REPAIRED_STATES if repaired else settings.states,
        iterations=ITERATIONS,
        tolerance=TOLERANCE,
        pseudo_count=0.0,
    )
    model.train(list(symbols.values()))
    likelihoods = np.array([model.log_likelihood(sequence) for sequence in symbols.values()])
    z = _robust_z(likelihoods / len(next(iter(symbols.values()))))
    order = np.argsort(-likelihoods, kind="stable")
    margins = [*(float(step) for step in -np.diff(likelihoods[order])), None]
    scores = tuple(
        Score(names[i], float(likelihoods[i]), rank + 1, rank < settings.keep, margin=margins[rank], z=float(z[i]))
        for rank, i in enumerate(order)
    )
    return Cluster(index, tuple(score.demonstration for score in scores), scores, model.history)


def _with_stability(score: Score, kept: Mapping[str, int], repeats: int) -> Score:
    return replace(score, stability=kept[score.demonstration] / repeats)


def _robust_z(scores: Array) -> Array:
    """Return by how many spreads each score lies above the median; the spread of few is mixed with the usual one."""
    measured = 1.4826 * float(np.median(np.abs(scores - np.median(scores))))
    spread = np.sqrt((len(scores) * measured**2 + PRIOR_MEMBERS * PRIOR_SPREAD**2) / (len(scores) + PRIOR_MEMBERS))
    return np.asarray((scores - np.median(scores)) / spread)
