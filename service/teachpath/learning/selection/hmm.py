"""The door to hmmlearn: left-right hidden Markov models on its compiled forward-backward.

Its own models would load scikit-learn, which takes longer than learning. Rabiner 1989, section III; the M-step keeps
every allowed transition possible, and that of the emissions every variance away from zero, so no likelihood is ever
infinite.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import Any

import numpy as np
from hmmlearn import _hmmc
from numpy.typing import NDArray
from scipy.special import logsumexp

from teachpath.records import Array

Statistics = dict[str, Any]
# Of one sequence: its log-likelihood, the probability of each state in each frame (frames, Q) up to a factor per frame,
# and the expected number of each transition (Q, Q).
ForwardBackward = tuple[float, Array, Array]

LOG_2PI = float(np.log(2 * np.pi))
# Nats, relative to the best state of every frame. Above it the recursions on densities are exact enough: what they
# round to 0 is at least 45 nats less likely than the best path through the chain. Below it logarithms are used.
MIN_SCALED_LOG_LIKELIHOOD = -700.0


class LeftRightHmm(ABC):
    """A left-right hidden Markov model: it starts in the first state, and stays in a state or goes to the next one.

    Subclasses define the emissions. Training starts from equal slices of time, one per state.

    Args:
        states: number Q of states; fewer are used when a training sequence is shorter.
        iterations: of Baum-Welch, at most.
        tolerance: training stops when the log-likelihood changes by less than this share of it.
        pseudo_count: added to every allowed transition in the M-step.
    """

    def __init__(
        self, *, states: int = 10, iterations: int = 20, tolerance: float = 1e-4, pseudo_count: float = 0.01
    ) -> None:
        self.states: int = states
        self.iterations: int = iterations
        self.tolerance: float = tolerance
        self.pseudo_count: float = pseudo_count
        self.history: tuple[float, ...] = ()  # log-likelihood of the training sequences before each M-step

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.states} states)"

    def train(self, sequences: Sequence[Array]) -> None:
        """Fit the model to sequences of shape (frames, features) by Baum-Welch."""
        self.n_components: int = min(self.states, *(len(sequence) for sequence in sequences))
        frames, lengths = np.concatenate(sequences), [len(sequence) for sequence in sequences]
        self._init(frames, lengths)
        self.history = ()
        while not self._is_converged():
            stats, likelihood = self._do_estep(frames, lengths)
            self._do_mstep(stats)
            self.history += (likelihood,)

    def log_likelihood(self, sequence: Array) -> float:
        """Return log p(O | model) of one sequence of shape (frames, features) by the forward procedure."""
        return float(self.log_likelihoods(sequence).sum())

    def log_likelihoods(self, sequence: Array) -> Array:
        """Return log p(o_t | o_1 ... o_t-1, model) for every frame: (frames,); their sum is the log-likelihood."""
        lattice = self._compute_log_likelihood(sequence)
        best = lattice.max(axis=1)
        try:
            total, _, scales = _hmmc.forward_scaling(self.startprob_, self.transmat_, np.exp(lattice - best[:, None]))
        except ValueError:  # underflow
            total = -np.inf
        if total > MIN_SCALED_LOG_LIKELIHOOD:
            return np.asarray(best - np.log(scales))
        forward = _hmmc.forward_log(self.startprob_, self.transmat_, lattice)[1]
        return np.diff(logsumexp(forward, axis=1), prepend=0.0)

    def _is_converged(self) -> bool:
        """Tell whether the log-likelihood changes little, up or down: a regularised M-step may lower it slightly."""
        if len(self.history) == self.iterations:
            return True
        if len(self.history) < 2:
            return False
        before, now = self.history[-2:]
        return abs(now - before) < self.tolerance * (abs(now) + abs(before)) / 2

    @abstractmethod
    def _compute_log_likelihood(self, X: Array) -> Array:
        """Return the log-density of frames (n, features) in every state: (n, Q)."""

    @abstractmethod
    def _begin(self, owners: NDArray[np.int64], frames: Array) -> None:
        """Initialise the emissions from frames (n, features); `owners` (n,) are the states of their time slices."""

    @abstractmethod
    def _maximise(self, frames: Array, posteriors: Array) -> None:
        """Maximise the likelihood of frames (n, features) whose state probabilities are `posteriors` (n, Q)."""

    def _init(self, X: Array, lengths: Sequence[int]) -> None:
        states = self.n_components
        self.n_features: int = X.shape[1]
        self.startprob_: Array = np.eye(states)[0]
        self.transmat_: Array = np.eye(states) + np.eye(states, k=1)
        self.transmat_ /= self.transmat_.sum(axis=1, keepdims=True)
        edges = (np.asarray(lengths)[:, None] * np.arange(states + 1)) // states
        self._begin(np.repeat(np.tile(np.arange(states), len(lengths)), np.diff(edges, axis=1).ravel()), X)

    def _do_estep(self, X: Array, lengths: Sequence[int]) -> tuple[Statistics, float]:
        lattice = self._compute_log_likelihood(X)
        best = lattice.max(axis=1)
        # The largest density of each frame is 1. hmmlearn's recursions are 20 times as fast on them as on logarithms.
        densities = np.exp(lattice - best[:, None])
        gamma, often, total = np.empty_like(lattice), np.zeros_like(self.transmat_), float(best.sum())
        for begin, end in pairwise(accumulate(lengths, initial=0)):
            part = slice(begin, end)
            passed = self._scaled_passes(densities[part]) or self._log_passes(lattice[part] - best[part, None])
            gamma[part] = passed[1]
            often += passed[2]
            total += passed[0]
        gamma /= gamma.sum(axis=1, keepdims=True)
        return {"frames": X, "posteriors": gamma, "trans": often}, total

    def _scaled_passes(self, densities: Array) -> ForwardBackward | None:
        """Run forward and backward over one sequence on densities; None where they underflow."""
        start, moves = self.startprob_, self.transmat_
        try:
            total, forward, scales = _hmmc.forward_scaling(start, moves, densities)
        except ValueError:  # underflow
            return None
        if total < MIN_SCALED_LOG_LIKELIHOOD:
            return None
        backward = _hmmc.backward_scaling(start, moves, densities, scales)
        return total, forward * backward, _hmmc.compute_scaling_xi_sum(forward, moves, backward, densities)

    def _log_passes(self, lattice: Array) -> ForwardBackward:
        start, moves = self.startprob_, self.transmat_
        total, forward = _hmmc.forward_log(start, moves, lattice)
        backward = _hmmc.backward_log(start, moves, lattice)
        often = np.exp(_hmmc.compute_log_xi_sum(forward, moves, backward, lattice))
        together = forward + backward
        return total, np.exp(together - together.max(axis=1, keepdims=True)), often

    def _do_mstep(self, stats: Statistics) -> None:
        counts = np.where(self.transmat_ > 0, stats["trans"] + self.pseudo_count, 0.0)
        rows = counts.sum(axis=1, keepdims=True)
        self.transmat_ = np.where(rows > 0, counts / np.where(rows > 0, rows, 1.0), self.transmat_)
        self._maximise(stats["frames"], stats["posteriors"])
