"""Dendrograms as scipy writes them, and their cuts: moving a cut needs no distances."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from teachpath.records import Array

Labels = NDArray[np.int64]


def members_by_label(names: Sequence[str], labels: Labels) -> tuple[tuple[str, ...], ...]:
    """Return the names that carry label 1, those that carry label 2, and so on."""
    found: list[list[str]] = [[] for _ in range(int(labels.max()))]
    for name, label in zip(names, labels, strict=True):
        found[label - 1].append(name)
    return tuple(tuple(group) for group in found)


def labels_at_height(linkage: Array, threshold: float) -> Labels:
    """Return the labels (m,) of a cut at a height [m]: all merges up to that height are made."""
    return _after(linkage, int(np.searchsorted(linkage[:, 2], threshold, side="right")))


def labels_for_count(linkage: Array, count: int) -> Labels:
    """Return the labels (m,) of the cut that leaves `count` clusters."""
    return _after(linkage, len(linkage) + 1 - count)


def height_for_count(linkage: Array, count: int) -> float:
    """Return a height [m] at which a cut leaves `count` clusters: halfway between two merges."""
    merges = len(linkage) + 1 - count
    heights = linkage[:, 2]
    if merges == len(linkage):
        return float(heights[-1]) if merges else 0.0
    below = float(heights[merges - 1]) if merges else 0.0
    return (below + float(heights[merges])) / 2


def extended_linkage(linkage: Array, sample: Labels, joins: Labels, heights: Array) -> Array:
    """Extend the dendrogram of a sample to all demonstrations: each of the others joins one of the sample.

    Args:
        linkage: of the sample.
        sample: (s,) demonstrations of the sample.
        joins: (m,) the demonstration that each one joins; those of the sample join themselves.
        heights: (m,) [m] at which they join.

    Returns:
        (m - 1, 4) merges as scipy writes them.
    """
    member = list(sample)  # one demonstration of every cluster of the sample's dendrogram
    merges: list[tuple[float, int, int]] = []
    for left, right, height, _ in linkage:
        merges.append((float(height), int(member[int(left)]), int(member[int(right)])))
        member.append(member[int(left)])
    merges += [(float(heights[i]), i, int(joins[i])) for i in map(int, np.flatnonzero(joins != np.arange(len(joins))))]
    merges.sort()
    return scipy_linkage(merges, len(joins))


def scipy_linkage(merges: Sequence[tuple[float, int, int]], count: int) -> Array:
    """Write merges of clusters, each cluster named by any of its members, as scipy does.

    Args:
        merges: height [m], a member of one cluster and a member of the other; sorted by height.
        count: number m of demonstrations.

    Returns:
        (m - 1, 4).
    """
    parent, name, size = np.arange(count), np.arange(count), np.ones(count, dtype=int)
    rows = np.empty((len(merges), 4))
    for row, (height, one, other) in enumerate(merges):
        left, right = sorted((_root(parent, one), _root(parent, other)), key=lambda at: name[at])
        size[left] += size[right]
        rows[row] = name[left], name[right], height, size[left]
        parent[right] = left
        name[left] = count + row
    return rows


def leaf_order(linkage: Array) -> Labels:
    """Return the demonstrations (m,) in an order that draws the dendrogram without crossings.

    The members of every cluster of every cut are neighbours in it. Of two merged clusters the one with the first
    member comes first.
    """
    m = len(linkage) + 1
    first = np.arange(2 * m - 1)
    for row, (left, right) in enumerate(linkage[:, :2].astype(int)):
        first[m + row] = min(first[left], first[right])
    order, waiting = [], [2 * m - 2]
    while waiting:
        node = waiting.pop()
        if node < m:
            order.append(node)
        else:
            waiting += sorted(linkage[node - m, :2].astype(int), key=lambda child: -first[child])
    return np.array(order, dtype=np.int64)


def _after(linkage: Array, merges: int) -> Labels:
    """Return the labels after so many merges: 1, 2, ... in the order of the clusters' first members."""
    m = len(linkage) + 1
    parent = np.arange(m + merges)
    for row in range(merges):
        parent[linkage[row, :2].astype(int)] = m + row
    for node in range(m + merges - 1, -1, -1):
        parent[node] = parent[parent[node]]
    _, first, inverse = np.unique(parent[:m], return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    return np.asarray(rank[inverse] + 1, dtype=np.int64)


def _root(parent: Labels, node: int) -> int:
    while parent[node] != node:
        parent[node] = parent[parent[node]]
        node = int(parent[node])
    return node
