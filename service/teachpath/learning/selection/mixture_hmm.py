"""The hidden Markov model of Aleotti & Caselli 2005: mixtures of Gaussians with full covariances.

The M-step is regularised as in Murphy's HMM Toolbox, which the paper used; it works in log space, where the toolbox's
linear densities run out of numbers.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from teachpath.learning.selection.hmm import LOG_2PI, LeftRightHmm
from teachpath.records import Array

KMEANS_ITERATIONS = 5


class MixtureHmm(LeftRightHmm):
    """A mixture of Gaussians with full covariances per state (Aleotti & Caselli 2005, eq. (3)).

    As in Murphy's HMM Toolbox, which the paper used, the Gaussians start from k-means over the frames of all states and
    are assigned to the states in arbitrary order, with random weights. With `time_sliced`, each state starts from its
    slice of time instead.

    Args:
        mixtures: number M of Gaussians per state.
        ridge: added to the diagonal of every covariance in every M-step.
        rng: draws the start.
        in_time: whether each state starts from its slice of time.
        options: see `LeftRightHmm`.
    """

    def __init__(
        self, mixtures: int, ridge: float, rng: np.random.Generator, *, time_sliced: bool = False, **options: Any
    ) -> None:
        super().__init__(**options)
        self.mixtures: int = mixtures
        self.ridge: float = ridge
        self.rng: np.random.Generator = rng
        self.time_sliced: bool = time_sliced

    def _begin(self, owners: NDArray[np.int64], frames: Array) -> None:
        shape = (self.n_components, self.mixtures)
        if self.time_sliced:
            slices = [frames[owners == state] for state in range(self.n_components)]
            picks = [self.rng.choice(len(part), self.mixtures, replace=len(part) < self.mixtures) for part in slices]
            means = np.stack([part[pick] for part, pick in zip(slices, picks, strict=True)])  # (Q, M, d)
            if self.mixtures == 1:
                means = np.stack([part.mean(axis=0) for part in slices])[:, None]
            spread = np.broadcast_to(np.cov(frames.T), (*shape, self.n_features, self.n_features))
            self.weights_: Array = np.full(shape, 1 / self.mixtures)
        else:
            means, spread = _start(frames, self.n_components * self.mixtures, self.rng)
            weights = self.rng.random(shape)
            self.weights_ = weights / weights.sum(axis=1, keepdims=True)
        self.means_: Array = means.reshape(*shape, self.n_features)
        ridge = self.ridge * np.eye(self.n_features)
        self.covariances_: Array = spread.reshape(*shape, self.n_features, self.n_features) + ridge

    def _log_components(self, X: Array) -> Array:
        offsets = X[:, None, None, :] - self.means_  # (frames, Q, M, d)
        whitening = np.linalg.inv(np.linalg.cholesky(self.covariances_))  # (Q, M, d, d), once for all frames
        whitened = np.einsum("qmij,tqmj->tqmi", whitening, offsets)
        log_determinant = np.linalg.slogdet(self.covariances_)[1]
        quadratic = np.square(whitened).sum(axis=3)
        return np.asarray(np.log(self.weights_) - 0.5 * (quadratic + log_determinant + self.n_features * LOG_2PI))

    def _compute_log_likelihood(self, X: Array) -> Array:
        return np.asarray(logsumexp(self._log_components(X), axis=2))

    def _maximise(self, frames: Array, posteriors: Array) -> None:
        components = self._log_components(frames)
        shares = np.exp(components - logsumexp(components, axis=2, keepdims=True))
        shares *= posteriors[:, :, None]  # (frames, Q, M)
        weight = shares.sum(axis=0)
        used = weight > 1e-8
        divisor = np.where(used, weight, 1.0)
        means = np.einsum("tqm,td->qmd", shares, frames) / divisor[..., None]
        self.means_ = np.where(used[..., None], means, self.means_)
        offsets = frames[:, None, None, :] - self.means_
        scatter = np.einsum("tqm,tqmi,tqmj->qmij", shares, offsets, offsets) / divisor[..., None, None]
        scatter = scatter + self.ridge * np.eye(self.n_features)
        self.covariances_ = np.where(used[..., None, None], scatter, self.covariances_)
        floor = np.maximum(weight, 1e-10)
        self.weights_ = floor / floor.sum(axis=1, keepdims=True)


def _start(frames: Array, count: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return the centres (count, d) of k-means over all frames and the covariances (count, d, d) of their cells.

    A cell too small for a covariance of full rank gets that of a unit sphere on top, as in Netlab's `gmminit`.
    """
    centres = frames[rng.choice(len(frames), count, replace=len(frames) < count)]
    cells = np.zeros(len(frames), dtype=int)
    for _ in range(KMEANS_ITERATIONS):
        cells = np.square(frames[:, None] - centres).sum(axis=2).argmin(axis=1)
        for k in np.unique(cells):
            centres[k] = frames[cells == k].mean(axis=0)
    d = frames.shape[1]
    covariances = np.broadcast_to(np.eye(d), (count, d, d)).copy()
    for k in np.unique(cells):
        offsets = frames[cells == k] - centres[k]
        own = offsets.T @ offsets / len(offsets)
        covariances[k] = own if np.linalg.matrix_rank(own) == d else own + np.eye(d)
    return centres, covariances
