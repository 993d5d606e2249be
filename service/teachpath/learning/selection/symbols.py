"""Trajectories as symbols in mode paper: short-time Fourier transform and vector quantisation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.cluster.vq import vq

from teachpath.records import Array

WINDOW = 20  # samples, Hamming
HOP = 10  # samples, half of the window
FFT_POINTS = 32  # points of the zero-padded transform
FFT_BINS = 16  # of its magnitudes, without the last
KMEANS_ITERATIONS = 30  # of k-means at most


def spectra(positions: Array) -> Array:
    """Transform a trajectory to short-time magnitude spectra (Aleotti & Caselli, eq. (2)).

    Args:
        positions: (n, 3) [m], n at least the window of 20.

    Returns:
        (frames, 3, 16): one 16-dimensional vector per window and axis.
    """
    stretches = sliding_window_view(positions, WINDOW, axis=0)[::HOP]
    return np.abs(np.fft.rfft(stretches * np.hamming(WINDOW), FFT_POINTS, axis=2))[..., :FFT_BINS]


def symbol_sequences(
    all_spectra: Sequence[Array], size: int, rng: np.random.Generator, *, ordered: bool = False
) -> list[Array]:
    """Quantise spectra axis by axis; each axis has its own codebook, trained on all demonstrations.

    The number of a codeword is arbitrary, because the codebook starts from randomly drawn vectors. With `ordered`, the
    codewords are numbered along their first principal component, so that near numbers stand for similar spectra.

    Args:
        all_spectra: for each demonstration (frames, 3, 16).
        size: codewords per axis; at most as many as there are vectors.
        rng: draws the first codewords.
        ordered: whether the codewords are numbered in that order.

    Returns:
        for each demonstration (frames, 3) codeword numbers 1, 2, ...
    """
    pooled = np.concatenate(all_spectra)
    ends = np.cumsum([len(frames) for frames in all_spectra])[:-1]
    columns = [_quantised(pooled[:, axis], size, rng, ordered) for axis in range(pooled.shape[1])]
    return np.split(np.column_stack(columns) + 1.0, ends)


def _quantised(vectors: Array, size: int, rng: np.random.Generator, ordered: bool) -> Array:
    codebook = vectors[rng.choice(len(vectors), min(size, len(vectors)), replace=False)]
    labels = vq(vectors, codebook)[0]
    for _ in range(KMEANS_ITERATIONS):
        codebook = np.stack(
            [vectors[labels == k].mean(axis=0) if np.any(labels == k) else codebook[k] for k in range(len(codebook))]
        )
        before, labels = labels, vq(vectors, codebook)[0]
        if np.array_equal(before, labels):
            break
    if ordered:
        offsets = codebook - codebook.mean(axis=0)
        along = offsets @ np.linalg.svd(offsets, full_matrices=False)[2][0]
        return np.asarray(np.argsort(np.argsort(along))[labels], dtype=np.float64)
    return np.asarray(labels, dtype=np.float64)
