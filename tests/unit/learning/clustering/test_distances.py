"""Distances against their definitions, and the compiled kernels against numpy."""

from __future__ import annotations

from itertools import combinations

import numba
import numpy as np
import pytest
from scipy.spatial.distance import cdist, squareform

from teachpath.errors import Cancelled
from teachpath.learning.clustering import kernels
from teachpath.learning.clustering.distances import nearest_paths, pairwise_distances
from teachpath.learning.matching import frechet_distance
from teachpath.records import Array

KINDS = {"arc": 0, "frechet": 1, "dtw": 2}


def walks(count: int, points: int = 20, seed: int = 1) -> Array:
    return 0.05 * np.random.default_rng(seed).normal(size=(count, points, 3)).cumsum(axis=1)


def leash(one: Array, other: Array) -> float:
    """Eiter & Mannila 1994, the recursion as printed."""
    apart = cdist(one, other)
    table = np.full(apart.shape, np.inf)
    for i, j in np.ndindex(apart.shape):
        before = min(
            (table[a, b] for a, b in ((i - 1, j), (i, j - 1), (i - 1, j - 1)) if a >= 0 and b >= 0), default=0.0
        )
        table[i, j] = max(before, apart[i, j])
    return float(table[-1, -1])


def matching(one: Array, other: Array) -> float:
    """The cheapest total cost of a monotone matching, divided by the steps of it."""
    apart = cdist(one, other)
    table: dict[tuple[int, int], tuple[float, int]] = {(-1, -1): (0.0, 0)}
    for i, j in np.ndindex(apart.shape):
        before = [table[at] for at in ((i - 1, j), (i, j - 1), (i - 1, j - 1)) if at in table]
        cost, steps = min(before, key=lambda entry: entry[0])
        table[i, j] = cost + float(apart[i, j]), steps + 1
        table.pop((-1, -1), None)
    cost, steps = table[len(one) - 1, len(other) - 1]
    return cost / steps


def test_the_distance_of_the_paper_is_the_mean_of_pointwise_distances() -> None:
    paths = walks(6)
    expected = [[np.mean([np.linalg.norm(p - q) for p, q in zip(a, b, strict=True)]) for b in paths] for a in paths]
    np.testing.assert_allclose(squareform(pairwise_distances(paths)), expected, atol=1e-12)


@pytest.mark.parametrize("metric", ["arc", "frechet"])
def test_the_distance_is_a_metric_of_paths(metric: str) -> None:
    square = squareform(pairwise_distances(walks(8), metric))
    assert np.all(square[:, :, None] <= square[:, None, :] + square.T[None, :, :] + 1e-12)


@pytest.mark.parametrize(("metric", "reference"), [("frechet", leash), ("dtw", matching)])
def test_warped_distances_follow_their_recursions(metric: str, reference: object) -> None:
    paths = walks(7)
    expected = [reference(a, b) for a, b in combinations(paths, 2)]  # type: ignore[operator]
    np.testing.assert_allclose(pairwise_distances(paths, metric), expected, atol=1e-12)


def test_warped_distances_do_not_mind_a_pause() -> None:
    path = walks(1, 30)[0]
    paused = np.concatenate([path[:10], np.repeat(path[10:11], 5, axis=0), path[10:]])
    other = np.concatenate([path, np.repeat(path[-1:], 5, axis=0)])
    for metric in ("frechet", "dtw"):
        assert pairwise_distances(np.stack([paused, other]), metric)[0] == pytest.approx(0.0, abs=1e-12)
    assert pairwise_distances(np.stack([paused, other]))[0] > 0.01


def test_the_frechet_distance_of_two_paths_is_that_of_the_matrix() -> None:
    one, other = walks(2)
    assert frechet_distance(one, other) == pairwise_distances(np.stack([one, other]), "frechet")[0]


def compiled(paths: Array, kind: int) -> Array:
    single = np.ascontiguousarray(paths.transpose(0, 2, 1), dtype=np.float32)
    blocks = kernels.blocks_of(single)
    out = np.empty(len(paths) * (len(paths) - 1) // 2, dtype=np.float32)
    for begin in range(0, len(paths), kernels.PATHS_PER_BLOCK):
        kernels.fill_rows(single, blocks, out, begin, kind)
    return out


@pytest.mark.parametrize("metric", ["arc", "frechet", "dtw"])
@pytest.mark.parametrize("count", [2, 24])
def test_the_kernels_agree_with_numpy(metric: str, count: int) -> None:
    paths = walks(count)
    np.testing.assert_allclose(compiled(paths, KINDS[metric]), pairwise_distances(paths, metric), rtol=1e-4, atol=1e-6)


def test_many_paths_are_measured_as_few_are() -> None:
    paths = walks(210)
    few = squareform(pairwise_distances(paths[-150:]))
    np.testing.assert_allclose(squareform(pairwise_distances(paths))[-150:, -150:], few, rtol=1e-5, atol=1e-7)


def test_far_from_the_origin_single_precision_is_enough() -> None:
    paths = walks(210)
    np.testing.assert_allclose(pairwise_distances(paths + 1e3), pairwise_distances(paths), rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize("kind", [0, 1, 2])
def test_the_number_of_threads_changes_no_bit(kind: int) -> None:
    paths = walks(150)
    threads = numba.get_num_threads()
    try:
        numba.set_num_threads(1)
        alone = compiled(paths, kind)
    finally:
        numba.set_num_threads(threads)
    np.testing.assert_array_equal(compiled(paths, kind), alone)


def test_the_nearest_of_a_sample_is_found() -> None:
    paths = walks(90)
    index, apart = nearest_paths(paths, paths[:7], "arc")
    square = squareform(pairwise_distances(paths))[:, :7]
    np.testing.assert_array_equal(index, square.argmin(axis=1))
    np.testing.assert_allclose(apart, square.min(axis=1), rtol=1e-4, atol=1e-6)


@pytest.mark.parametrize(("metric", "count"), [("arc", 30), ("arc", 250), ("dtw", 20)])
def test_measuring_tells_its_progress_and_can_be_cancelled(metric: str, count: int) -> None:
    told: list[float] = []
    pairwise_distances(walks(count, 8), metric, lambda fraction, _: told.append(fraction))
    assert told == sorted(told)
    assert told[0] == 0.0

    def cancel(_fraction: float, _sentence: str) -> None:
        raise Cancelled("enough")

    with pytest.raises(Cancelled):
        pairwise_distances(walks(count, 8), metric, cancel)
