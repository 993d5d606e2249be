"""Laws of the hidden Markov models: Baum-Welch climbs, nothing collapses, the chain never goes back."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hmmlearn import _hmmc

from teachpath.learning.selection.gaussian_hmm import TiedGaussianHmm
from teachpath.learning.selection.hmm import LeftRightHmm
from teachpath.learning.selection.mixture_hmm import MixtureHmm
from teachpath.records import Array


def sequences(seed: int = 1, count: int = 4, frames: int = 30, features: int = 3) -> list[Array]:
    rng = np.random.default_rng(seed)
    ramp = np.linspace(0.0, 3.0, frames)[:, None]
    return [ramp + rng.normal(0, 0.4, (frames, features)) for _ in range(count)]


def tied(floor: float = 1e-12, **options: object) -> TiedGaussianHmm:
    return TiedGaussianHmm(np.full(3, floor), **options)  # type: ignore[arg-type]


def mixture(ridge: float = 0.01, **options: object) -> MixtureHmm:
    return MixtureHmm(2, ridge, np.random.default_rng(1), **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", range(3))
def test_baum_welch_without_regularisation_never_lowers_the_likelihood(seed: int) -> None:
    options = {"states": 4, "iterations": 15, "tolerance": 0.0, "pseudo_count": 0.0}
    for model in (tied(**options), mixture(ridge=1e-9, **options)):
        model.train(sequences(seed, frames=60))
        history = np.array(model.history)
        assert len(history) > 2
        assert np.all(np.diff(history) >= -1e-6 * np.abs(history[:-1]))


def test_training_stops_at_the_tolerance_or_the_last_iteration() -> None:
    patient, hasty = tied(states=4, iterations=50, tolerance=1e-3), tied(states=4, iterations=3, tolerance=0.0)
    patient.train(sequences())
    hasty.train(sequences())
    assert len(patient.history) < 50
    assert len(hasty.history) == 3


@pytest.mark.parametrize("make", [tied, mixture])
def test_the_chain_only_stays_or_moves_on(make: type[LeftRightHmm]) -> None:
    model = make(states=6)
    model.train(sequences())
    allowed = np.eye(6) + np.eye(6, k=1) > 0
    assert np.all(model.transmat_[~allowed] == 0)
    assert np.all(model.transmat_[allowed] > 0)
    np.testing.assert_allclose(model.transmat_.sum(axis=1), 1.0)
    np.testing.assert_array_equal(model.startprob_, np.eye(6)[0])


@pytest.mark.parametrize("make", [tied, mixture])
def test_the_likelihood_is_the_sum_over_all_ways_through_the_chain(make: type[LeftRightHmm]) -> None:
    model = make(states=3)
    model.train(sequences())
    observed = sequences(9, count=1, frames=5)[0]
    emission = np.exp(model._compute_log_likelihood(observed))
    total = 0.0
    for way in product(range(3), repeat=5):
        p = model.startprob_[way[0]] * emission[0, way[0]]
        for t in range(1, 5):
            p *= model.transmat_[way[t - 1], way[t]] * emission[t, way[t]]
        total += p
    assert model.log_likelihood(observed) == pytest.approx(np.log(total), rel=1e-9)
    assert model.log_likelihoods(observed).sum() == pytest.approx(np.log(total), rel=1e-9)


@pytest.mark.parametrize("make", [tied, mixture])
@pytest.mark.parametrize("off", [0.0, 0.5, 5.0, 50.0, 1e4])
def test_scaled_numbers_give_what_logarithms_do(make: type[LeftRightHmm], off: float) -> None:
    model = make(states=6)
    model.train(sequences())
    for sequence in (sequences(3, count=1)[0] + off, sequences(3, count=1)[0][::-1] + off):
        lattice = model._compute_log_likelihood(sequence)
        total, forward = _hmmc.forward_log(model.startprob_, model.transmat_, lattice)
        backward = _hmmc.backward_log(model.startprob_, model.transmat_, lattice)
        often = np.exp(_hmmc.compute_log_xi_sum(forward, model.transmat_, backward, lattice))
        stats, found = model._do_estep(sequence, [len(sequence)])
        assert found == pytest.approx(total, rel=1e-10)
        assert model.log_likelihood(sequence) == pytest.approx(total, rel=1e-10)
        np.testing.assert_allclose(stats["posteriors"], np.exp(forward + backward - total), atol=1e-4)
        np.testing.assert_allclose(stats["trans"], often, atol=1e-3)


@pytest.mark.parametrize("make", [tied, mixture])
@pytest.mark.parametrize(
    "awkward",
    [
        [np.zeros((20, 3))] * 3,
        [np.ones((2, 3)), np.zeros((40, 3))],
        [np.zeros((1, 3))],
        [np.full((30, 3), 1e6), np.zeros((30, 3))],
    ],
    ids=["constant", "very short", "one frame", "far apart"],
)
def test_nothing_is_ever_infinite(make: type[LeftRightHmm], awkward: list[Array]) -> None:
    model = make(states=10) if make is mixture else tied(floor=1e-6, states=10)
    model.train(awkward)
    scores = [model.log_likelihood(sequence) for sequence in [*awkward, np.full((7, 3), 1e3)]]
    assert np.all(np.isfinite(scores))
    assert np.all(np.isfinite(model.history))
    assert np.all(np.isfinite(model.transmat_))


def test_a_sequence_like_the_training_is_likelier_than_its_reverse() -> None:
    model = tied(floor=1e-6, states=6)
    model.train(sequences(1))
    other = sequences(2, count=1)[0]
    assert model.log_likelihood(other) > model.log_likelihood(other[::-1])


def test_the_order_of_training_sequences_does_not_matter() -> None:
    forward, backward = tied(states=5), tied(states=5)
    forward.train(sequences())
    backward.train(sequences()[::-1])
    np.testing.assert_allclose(forward.means_, backward.means_, atol=1e-10)
    np.testing.assert_allclose(forward.history, backward.history, rtol=1e-10)


@pytest.mark.parametrize("time_sliced", [False, True])
def test_a_start_in_time_puts_the_states_in_order(time_sliced: bool) -> None:
    model = mixture(states=5, iterations=1, time_sliced=time_sliced)
    model.train([np.linspace(0.0, 50.0, 40)[:, None] + np.zeros((40, 3)) for _ in range(3)])
    ordered = bool(np.all(np.diff(model.means_[:, :, 0].mean(axis=1)) > 0))
    assert ordered == time_sliced


@pytest.mark.parametrize("count", [2, 3, 8])
def test_a_widened_model_expects_new_sequences_as_far_off_as_they_are(count: int) -> None:
    rng = np.random.default_rng(3)
    off, expected = [], []
    for _ in range(200):
        places = rng.normal(0, 0.4, (count + 1, 1, 3)) * np.ones((count + 1, 10, 3))
        model = tied(states=1, iterations=1)
        model.train(list(places[1:]))
        model.widen(count)
        off.append(np.square(places[0] - model.means_[0]))
        expected.append(model.variance_)
    assert np.mean(off) == pytest.approx(np.mean(expected), rel=0.2)
