"""Left-right hidden Markov models on hmmlearn's compiled forward-backward, with emissions that cannot collapse.

Rabiner 1989, section III; the regularised M-step keeps every variance away from zero and every allowed transition
possible, so no likelihood is ever infinite.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from hmmlearn import _hmmc
from hmmlearn.base import BaseHMM, ConvergenceMonitor
from scipy.special import logsumexp

from teachpath.records import Array

Statistics = dict[str, Any]

LOG_2PI = float(np.log(2 * np.pi))
ONE_ONLY = 4.0  # factor on the variance of a model of one sequence


class LeftRightHmm(BaseHMM):  # type: ignore[misc]
    """A chain of states that may only be kept or left for the next, begun in the first.

    Subclasses give the emission of a state. Training starts from equal slices of time, one per state.

    Args:
        states: number Q of states; fewer are used when a training sequence is shorter.
        iterations: most iterations of Baum-Welch.
        tolerance: training stops when the log-likelihood changes by less than this share of it.
        pseudo_count: added to every allowed transition in the M-step.
    """

    def __init__(
        self, *, states: int = 10, iterations: int = 20, tolerance: float = 1e-4, pseudo_count: float = 0.01
    ) -> None:
        super().__init__(n_components=states, n_iter=iterations, tol=tolerance, implementation="log")
        self.states = states
        self.pseudo_count = pseudo_count
        self.monitor_ = _RelativeChange(tolerance, iterations, False)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.states} states)"

    @property
    def history(self) -> tuple[float, ...]:
        """Log-likelihood of the training sequences before each M-step."""
        return tuple(float(value) for value in self.monitor_.history)

    def train(self, sequences: Sequence[Array]) -> None:
        """Fit the model to sequences of shape (frames, features) by Baum-Welch."""
        self.n_components = min(self.states, *(len(sequence) for sequence in sequences))
        self.fit(np.concatenate(sequences), [len(sequence) for sequence in sequences])

    def log_likelihood(self, sequence: Array) -> float:
        """Return log p(O | model) of one sequence of shape (frames, features) by the forward procedure."""
        return float(self.score(sequence))

    def log_likelihoods(self, sequence: Array) -> Array:
        """Return log p(o_t | o_1 ... o_t-1, model) for every frame: (frames,); their sum is the log-likelihood."""
        forward = _hmmc.forward_log(self.startprob_, self.transmat_, self._compute_log_likelihood(sequence))[1]
        return np.diff(logsumexp(forward, axis=1), prepend=0.0)

    @abstractmethod
    def _begin(self, slices: list[Array], frames: Array) -> None:
        """Set the emissions from the frames of each state's time slice."""

    def _init(self, X: Array, lengths: Sequence[int]) -> None:
        states = self.n_components
        self.n_features = X.shape[1]
        self.startprob_ = np.eye(states)[0]
        self.transmat_ = np.eye(states) + np.eye(states, k=1)
        self.transmat_ /= self.transmat_.sum(axis=1, keepdims=True)
        bounds = np.concatenate([[0], np.cumsum(lengths)])
        edges = [np.linspace(begin, end, states + 1).astype(int) for begin, end in pairwise(bounds)]
        slices = [np.concatenate([X[edge[q] : edge[q + 1]] for edge in edges]) for q in range(states)]
        self._begin(slices, X)

    def _compute_posteriors_log(self, fwdlattice: Array, bwdlattice: Array) -> Array:
        # hmmlearn's own goes through scipy's logsumexp, which takes longer than the compiled recursions.
        log_gamma = fwdlattice + bwdlattice
        gamma = np.exp(log_gamma - log_gamma.max(axis=1, keepdims=True))
        return np.asarray(gamma / gamma.sum(axis=1, keepdims=True))

    def _compute_lower_bound(self, curr_logprob: float) -> float:
        return curr_logprob

    def _do_mstep(self, stats: Statistics) -> None:
        counts = np.where(self.transmat_ > 0, stats["trans"] + self.pseudo_count, 0.0)
        rows = counts.sum(axis=1, keepdims=True)
        self.transmat_ = np.where(rows > 0, counts / np.where(rows > 0, rows, 1.0), self.transmat_)


class TiedGaussianHmm(LeftRightHmm):
    """One Gaussian per state, with one diagonal covariance that all states share.

    Args:
        floor: (features,) least variance.
        options: see `LeftRightHmm`.
    """

    def __init__(self, floor: Array, **options: Any) -> None:
        super().__init__(**options)
        self.floor = floor

    def widen(self, sequences: int) -> None:
        """Widen the variance to what a new sequence shows against means that were estimated from so few.

        The variance about the estimated means is too small by (n - 1) / n, that of a new sequence larger than the true
        one by (n + 1) / n.
        """
        self.variance_ *= (sequences + 1) / (sequences - 1) if sequences > 1 else ONE_ONLY

    def _begin(self, slices: list[Array], frames: Array) -> None:
        self.means_ = np.stack([part.mean(axis=0) for part in slices])
        squares = sum(np.square(part - mean).sum(axis=0) for part, mean in zip(slices, self.means_, strict=True))
        self.variance_ = np.maximum(squares / len(frames), self.floor)

    def _compute_log_likelihood(self, X: Array) -> Array:
        scaled = np.square(X[:, None, :] - self.means_) / self.variance_  # (frames, states, features)
        constant = self.n_features * LOG_2PI + np.log(self.variance_).sum()
        return np.asarray(-0.5 * (scaled.sum(axis=2) + constant))

    def _initialize_sufficient_statistics(self) -> Statistics:
        stats: Statistics = super()._initialize_sufficient_statistics()
        stats["weight"] = np.zeros(self.n_components)
        stats["first"] = np.zeros((self.n_components, self.n_features))
        stats["frames"] = []
        return stats

    def _accumulate_sufficient_statistics(
        self, stats: Statistics, X: Array, lattice: Array, posteriors: Array, fwdlattice: Array, bwdlattice: Array
    ) -> None:
        super()._accumulate_sufficient_statistics(stats, X, lattice, posteriors, fwdlattice, bwdlattice)
        stats["weight"] += posteriors.sum(axis=0)
        stats["first"] += posteriors.T @ X
        stats["frames"].append((X, posteriors))

    def _do_mstep(self, stats: Statistics) -> None:
        super()._do_mstep(stats)
        weight = stats["weight"][:, None]
        self.means_ = np.where(weight > 1e-8, stats["first"] / np.maximum(weight, 1e-8), self.means_)
        X, posteriors = (np.concatenate(parts) for parts in zip(*stats["frames"], strict=True))
        squares = np.einsum("tq,tqd->d", posteriors, np.square(X[:, None, :] - self.means_))
        self.variance_ = np.maximum(squares / weight.sum(), self.floor)


class _RelativeChange(ConvergenceMonitor):  # type: ignore[misc]
    """Stops at a relative change of the log-likelihood; a regularised M-step may lower it a little."""

    def report(self, log_prob: float) -> None:
        self.history.append(log_prob)
        self.iter += 1

    @property
    def converged(self) -> bool:
        if self.iter == self.n_iter:
            return True
        if len(self.history) < 2:
            return False
        before, now = self.history[-2], self.history[-1]
        return bool(abs(now - before) < self.tol * (abs(now) + abs(before)) / 2)
