"""The log-likelihood of every member of a cluster under hidden Markov models of the others (Fig. 4, Table I)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teachpath.learning.selection.gaussian_hmm import TrainingBudget, train_model
from teachpath.learning.settings import StepCallback
from teachpath.records import Array

COURSE_STATES = 10
MAX_LEAVE_ONE_OUT = 30  # members up to which each is scored by a model of all others
MAX_FOLDS = 10  # above
BUDGET = TrainingBudget()


def fold_count(members: int) -> int:
    """Return into how many parts the members are split; models of the other parts score a part."""
    return MAX_FOLDS if members > MAX_LEAVE_ONE_OUT else members


def score_likelihoods(sequences: Sequence[Array], *, on_step: StepCallback) -> Array:
    """Return the log-likelihood of every sequence (frames, features) under a model of others, never of itself: (m,).

    Args:
        sequences: of at least two members.
        on_step: called once per trained model.
    """
    folds = fold_count(len(sequences))
    likelihoods = np.empty(len(sequences))
    for fold in range(folds):
        others = [sequence for i, sequence in enumerate(sequences) if i % folds != fold]
        model = train_model(others, COURSE_STATES, BUDGET)
        for i in range(fold, len(sequences), folds):
            likelihoods[i] = model.log_likelihood(sequences[i])
        on_step()
    return likelihoods


def convergence(sequences: Sequence[Array]) -> tuple[float, ...]:
    """Return the log-likelihoods while a model of all members is trained (Fig. 4)."""
    return train_model(sequences, COURSE_STATES, BUDGET).history
