"""Laws of the spectra and the codebook."""

from __future__ import annotations

import numpy as np
import pytest

from teachpath.learning.selection.symbols import spectra, symbol_sequences

T = np.arange(159) * 0.02


def test_the_shape_is_that_of_the_paper() -> None:
    assert spectra(np.random.default_rng(1).normal(size=(159, 3))).shape == (14, 3, 16)
    assert spectra(np.zeros((20, 3))).shape == (1, 3, 16)


@pytest.mark.parametrize("frequency", [3.125, 6.25, 12.5])
def test_a_sine_has_its_peak_at_its_own_frequency(frequency: float) -> None:
    wave = np.column_stack([np.sin(2 * np.pi * frequency * T)] * 3)
    peaks = spectra(wave).argmax(axis=2) * 50 / 32
    np.testing.assert_allclose(peaks, frequency, atol=50 / 32)


def test_spectra_are_linear_in_the_amplitude() -> None:
    positions = np.random.default_rng(2).normal(size=(100, 3))
    np.testing.assert_allclose(spectra(3 * positions), 3 * spectra(positions), rtol=1e-12)


def test_symbols_are_whole_numbers_from_one_and_equal_vectors_get_equal_ones() -> None:
    rng = np.random.default_rng(3)
    first = rng.normal(size=(14, 3, 16))
    sequences = symbol_sequences([first, rng.normal(size=(14, 3, 16)), first], 20, np.random.default_rng(1))
    labels = np.concatenate(sequences)
    assert np.all(labels == np.round(labels))
    assert labels.min() >= 1
    assert labels.max() <= 20
    np.testing.assert_array_equal(sequences[0], sequences[2])


def test_ordered_codewords_of_near_spectra_have_near_numbers() -> None:
    loudness = np.random.default_rng(5).uniform(1.0, 9.0, 60)
    growing = loudness[:, None, None] * np.ones((1, 3, 16))
    (labels,) = symbol_sequences([growing], 12, np.random.default_rng(1), ordered=True)
    for axis in range(3):
        rising = labels[np.argsort(loudness), axis]
        assert np.all(np.diff(rising) >= 0) or np.all(np.diff(rising) <= 0)


def test_a_codebook_larger_than_the_vectors_gives_each_its_own_symbol() -> None:
    labels = symbol_sequences([np.random.default_rng(4).normal(size=(10, 3, 16))], 64, np.random.default_rng(1))[0]
    assert all(len(set(labels[:, axis])) == 10 for axis in range(3))
