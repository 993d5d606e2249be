"""Distances between thousands of paths, compiled, in single precision, on every core.

One thread computes each distance in an order that the source fixes, so the number of threads changes no bit.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from teachpath.compiled import compiled
from teachpath.records import Array

Labels = NDArray[np.int64]
Paths = NDArray[np.float32]  # (m, 3, n): one row a coordinate, so that the inner loops run along memory
Blocks = NDArray[np.float32]  # (blocks, n, 3, 64): 64 paths beside one another, so that one instruction takes several

PATHS_PER_BLOCK = 64  # paths compared with as many: both sets stay in the cache


@compiled()
def _mean_distances(path: Paths, block: Blocks, means: Paths) -> None:
    n = path.shape[1]
    for j in range(PATHS_PER_BLOCK):
        means[j] = np.float32(0)
    for k in range(n):
        x, y, z = path[0, k], path[1, k], path[2, k]
        xs, ys, zs = block[k, 0], block[k, 1], block[k, 2]
        for j in range(PATHS_PER_BLOCK):
            dx, dy, dz = xs[j] - x, ys[j] - y, zs[j] - z
            means[j] += np.sqrt(dx * dx + dy * dy + dz * dz)
    for j in range(PATHS_PER_BLOCK):
        means[j] /= np.float32(n)


@compiled()
def _warped_distance(a: Paths, b: Paths, widest: bool) -> np.float32:
    n = a.shape[1]
    cost = np.empty(n, dtype=np.float32)
    steps = np.ones(n, dtype=np.float32)
    for i in range(n):
        diagonal, diagonal_steps = np.float32(0), np.float32(0)
        for j in range(n):
            x, y, z = a[0, i] - b[0, j], a[1, i] - b[1, j], a[2, i] - b[2, j]
            here = np.sqrt(x * x + y * y + z * z)
            before, before_steps = np.float32(np.inf), np.float32(0)
            if i > 0:
                before, before_steps = cost[j], steps[j]
            if j > 0 and cost[j - 1] < before:
                before, before_steps = cost[j - 1], steps[j - 1]
            if i > 0 and j > 0 and diagonal <= before:
                before, before_steps = diagonal, diagonal_steps
            if i == 0 and j == 0:
                before = np.float32(0)
            diagonal, diagonal_steps = cost[j], steps[j]
            cost[j] = max(here, before) if widest else here + before
            steps[j] = before_steps + np.float32(1)
    return np.float32(cost[n - 1] if widest else cost[n - 1] / steps[n - 1])


@compiled(parallel=True)
def _fill(paths: Paths, blocks: Blocks, out: NDArray[np.float32], begin: int, kind: int) -> None:
    m = len(paths)
    end = min(begin + PATHS_PER_BLOCK, m)
    strip = begin // PATHS_PER_BLOCK
    for block in numba.prange(len(blocks) - strip):
        first = begin + block * PATHS_PER_BLOCK
        means = np.empty(PATHS_PER_BLOCK, dtype=np.float32)
        for i in range(begin, end):
            row = i * (2 * m - i - 1) // 2 - i - 1
            if kind == 0:
                _mean_distances(paths[i], blocks[strip + block], means)
            for j in range(max(first, i + 1), min(first + PATHS_PER_BLOCK, m)):
                out[row + j] = means[j - first] if kind == 0 else _warped_distance(paths[i], paths[j], kind == 1)


@compiled(parallel=True)
def _assign(paths: Paths, chosen: Paths, blocks: Blocks, nearest: Labels, apart: Array, kind: int) -> None:
    for i in numba.prange(len(paths)):
        apart[i] = np.inf
        means = np.empty(PATHS_PER_BLOCK, dtype=np.float32)
        for j in range(len(chosen)):
            if kind == 0 and j % PATHS_PER_BLOCK == 0:
                _mean_distances(paths[i], blocks[j // PATHS_PER_BLOCK], means)
            here = means[j % PATHS_PER_BLOCK] if kind == 0 else _warped_distance(paths[i], chosen[j], kind == 1)
            if here < apart[i]:
                apart[i] = here
                nearest[i] = j


@compiled()
def _between(row: int, column: int, count: int) -> int:
    low, high = min(row, column), max(row, column)
    return low * (2 * count - low - 1) // 2 + high - low - 1


@compiled()
def _merge(apart: NDArray[np.float32], sizes: Labels, chain: Labels, state: Labels, merges: Array, budget: int) -> None:
    count = len(sizes)
    length, done = state
    for _ in range(min(budget, count - 1 - done)):
        if length == 0:
            chain[0], length = np.argmax(sizes > 0), 1
        while True:  # on to the nearest neighbour, until two are each other's
            here = chain[length - 1]
            nearest, least = here, np.float32(np.inf)
            if length > 1:
                nearest = chain[length - 2]
                least = apart[_between(here, nearest, count)]
            for other in range(count):
                if sizes[other] > 0 and other != here and apart[_between(here, other, count)] < least:
                    nearest, least = other, apart[_between(here, other, count)]
            if length > 1 and nearest == chain[length - 2]:
                break
            chain[length] = nearest
            length += 1
        length -= 2
        gone, stays = min(here, nearest), max(here, nearest)
        merges[done, 0], merges[done, 1], merges[done, 2] = gone, stays, least
        done += 1
        one, two = sizes[gone], sizes[stays]
        sizes[gone], sizes[stays] = 0, one + two
        for other in range(count):
            if sizes[other] > 0 and other != stays:
                mine, theirs = _between(other, stays, count), _between(other, gone, count)
                apart[mine] = (one * np.float64(apart[theirs]) + two * np.float64(apart[mine])) / (one + two)
    state[0], state[1] = length, done


def merge(apart: NDArray[np.float32], sizes: Labels, chain: Labels, state: Labels, merges: Array, budget: int) -> None:
    """Make the next `budget` merges of average linkage along chains of nearest neighbours (Murtagh 1983).

    The merges are not sorted by height; they name a cluster by one of its members.

    Args:
        apart: (m (m - 1) / 2,) distances, condensed in scipy's order; overwritten by the distances of clusters.
        sizes: (m,) of the clusters, at first 1; 0 for a cluster that was merged into another.
        chain: (m,) the chain of nearest neighbours.
        state: length of the chain and number of merges made; at first 0 and 0.
        merges: (m - 1, 4), filled with two members and the height.
        budget: number of merges to make.
    """
    _merge(apart, sizes, chain, state, merges, budget)


def blocks_of(paths: Paths) -> Blocks:
    """Return paths (m, 3, n) in blocks of 64, the last block filled up with zeros: (blocks, n, 3, 64)."""
    m, _, n = paths.shape
    padded = np.zeros((-(-m // PATHS_PER_BLOCK) * PATHS_PER_BLOCK, 3, n), dtype=np.float32)
    padded[:m] = paths
    return np.ascontiguousarray(padded.reshape(-1, PATHS_PER_BLOCK, 3, n).transpose(0, 3, 2, 1))


def fill_rows(paths: Paths, blocks: Blocks, out: NDArray[np.float32], begin: int, kind: int) -> None:
    """Write the distances of paths `begin` to `begin` + 63 from all later ones into `out`, condensed in scipy's order.

    Args:
        paths: (m, 3, n) [m].
        blocks: the same paths, see `blocks_of`.
        out: (m (m - 1) / 2,) [m].
        begin: first row of the strip, a multiple of 64.
        kind: 0 = mean distance of corresponding points (Aleotti & Caselli, eq. (1)), 1 = discrete Fréchet distance,
            2 = dynamic time warping, mean cost along the best matching.
    """
    _fill(paths, blocks, out, begin, kind)


def nearest_paths(paths: Paths, chosen: Paths, kind: int) -> tuple[NDArray[np.int64], Array]:
    """Return for every path the number of the nearest chosen one and its distance [m]; kinds as in `fill_rows`."""
    nearest = np.zeros(len(paths), dtype=np.int64)
    apart = np.empty(len(paths))
    _assign(paths, chosen, blocks_of(chosen), nearest, apart, kind)
    return nearest, apart
