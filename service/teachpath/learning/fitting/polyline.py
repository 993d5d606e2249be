"""Nearest points on polylines."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from teachpath.records import Array


def nearest_on_polyline(tree: cKDTree, vertices: Array, points: Array) -> tuple[Array, Array]:
    """Find the nearest place of a polyline on the two segments beside the vertex nearest to each point.

    Args:
        tree: of the vertices.
        vertices: (k, d) [m], at least two.
        points: (n, d) [m].

    Returns:
        (n,) distances [m], and (n,) places: the number of a vertex and the share of the segment behind it.
    """
    nearest = np.asarray(tree.query(points)[1])
    before, after = np.maximum(nearest - 1, 0), np.minimum(nearest + 1, len(vertices) - 1)
    left, share = _on_segments(points, vertices[before], vertices[nearest])
    right, other = _on_segments(points, vertices[nearest], vertices[after])
    return np.minimum(left, right), np.where(left < right, before + share, nearest + other)


def _on_segments(points: Array, begin: Array, end: Array) -> tuple[Array, Array]:
    along = end - begin
    square = np.square(along).sum(axis=1)
    share = np.divide(((points - begin) * along).sum(axis=1), square, out=np.zeros(len(points)), where=square > 0)
    share = np.clip(share, 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - begin - share[:, None] * along, axis=1)), share
