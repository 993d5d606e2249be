"""The hidden Markov model of mode default: Gaussians that share one diagonal covariance, with a floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from teachpath.learning.selection.hmm import LOG_2PI, LeftRightHmm
from teachpath.records import Array

SINGLE_SEQUENCE_FACTOR = 4.0  # factor on the variance of a model of one sequence
VARIANCE_FLOOR_SHARE = 0.02  # of the overall variance, which the variance of the states keeps at least


@dataclass(frozen=True)
class TrainingBudget:
    """Limits of the training of one model; measured, more iterations or sequences make no better model.

    Attributes:
        iterations: of Baum-Welch, at most.
        sequences: that the model is trained on, at most.
    """

    iterations: int = 8
    sequences: int = 30


def train_model(sequences: Sequence[Array], states: int, budget: TrainingBudget) -> TiedGaussianHmm:
    """Train a model on sequences of shape (frames, features); of too many, evenly picked ones are taken."""
    if len(sequences) > budget.sequences:
        sequences = [sequences[i] for i in np.linspace(0, len(sequences) - 1, budget.sequences).astype(int)]
    variance = np.concatenate(sequences).var(axis=0)
    # A direction in which nothing moves must not weigh more than the others.
    floor = np.maximum(VARIANCE_FLOOR_SHARE * variance, 1e-3 * VARIANCE_FLOOR_SHARE * variance.max() + 1e-12)
    model = TiedGaussianHmm(floor, states=states, iterations=budget.iterations)
    model.train(sequences)
    model.widen(len(sequences))
    return model


class TiedGaussianHmm(LeftRightHmm):
    """One Gaussian per state, with one diagonal covariance that all states share.

    Args:
        floor: (features,) least variance.
        options: see `LeftRightHmm`.
    """

    def __init__(self, floor: Array, **options: Any) -> None:
        super().__init__(**options)
        self.floor: Array = floor

    def widen(self, sequences: int) -> None:
        """Widen the variance to that of a new sequence about means that were estimated from so few sequences.

        With n sequences, the variance about the estimated means is too small by the factor (n - 1) / n, and that of a
        new sequence about them is larger than the true variance by (n + 1) / n.
        """
        self.variance_ *= (sequences + 1) / (sequences - 1) if sequences > 1 else SINGLE_SEQUENCE_FACTOR

    def _begin(self, owners: NDArray[np.int64], frames: Array) -> None:
        self.means_: Array = np.zeros((self.n_components, self.n_features))
        self._maximise(frames, np.eye(self.n_components)[owners])

    def _compute_log_likelihood(self, X: Array) -> Array:
        scaled = np.square(X[:, None, :] - self.means_) / self.variance_  # (frames, states, features)
        constant = self.n_features * LOG_2PI + np.log(self.variance_).sum()
        return np.asarray(-0.5 * (scaled.sum(axis=2) + constant))

    def _maximise(self, frames: Array, posteriors: Array) -> None:
        weight = posteriors.sum(axis=0)[:, None]
        # A matrix product would round differently with another number of threads.
        first = np.einsum("tq,td->qd", posteriors, frames)
        self.means_ = np.where(weight > 1e-8, first / np.maximum(weight, 1e-8), self.means_)
        squares = np.einsum("tq,tqd->d", posteriors, np.square(frames[:, None, :] - self.means_))
        self.variance_: Array = np.maximum(squares / weight.sum(), self.floor)
