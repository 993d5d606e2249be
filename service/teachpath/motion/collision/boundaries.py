"""Boundaries: half-spaces that bodies stay in, from the floor and the faces of keep-in zones, and distances to them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.rotations import rotation_matrices
from teachpath.records import Scene, Shape

FLOOR: Final = "the floor"


@dataclass(frozen=True, eq=False)
class Boundary:
    """A half-space in which bodies stay: all points p with normal . p >= offset.

    Attributes:
        name: of what lies beyond, in a sentence.
        normal: (3,) unit vector into the half-space [world].
        offset: [m].
    """

    name: str
    normal: Array
    offset: float


def scene_boundaries(scene: Scene) -> list[Boundary]:
    """Return the boundaries of a scene: its floor first, then the faces of its keep-in zones."""
    floor = Boundary(FLOOR, np.array([0.0, 0.0, 1.0]), scene.floor)
    return [floor, *(face for zone in scene.keep_in for face in _faces(zone))]


def _faces(box: Shape) -> list[Boundary]:
    axes, centre = rotation_matrices(np.array([box.orientation]))[0], np.array(box.position)
    name = f"the outside of the keep-in zone {box.name}"
    return [
        Boundary(name, sign * axis, float(sign * axis @ centre - edge / 2))
        for axis, edge in zip(axes.T, box.size, strict=True)
        for sign in (1.0, -1.0)
    ]


@dataclass(frozen=True, eq=False)
class Extent:
    """How far a convex body reaches: the hull of points, widened by a disc in its xy plane and by a ball.

    Attributes:
        points: (m, 3) in the body's frame [m].
        disc: radius [m].
        ball: radius [m].
    """

    points: Array
    disc: float = 0.0
    ball: float = 0.0

    def along(self, directions: Array) -> Array:
        """Return how far (n,) [m] the body reaches from its origin along unit vectors (n, 3) of its frame."""
        corners = (directions @ self.points.T).max(axis=1)
        return np.asarray(corners + self.disc * np.hypot(directions[:, 0], directions[:, 1]) + self.ball)


def boundary_distances(
    pairs: list[tuple[int, Boundary]], extents: Mapping[int, Extent], places: Array, turns: Array
) -> Array:
    """Return how far (n, pairs) [m] each body of a pair lies within its half-space; negative where a part is beyond.

    A convex body lies within a half-space by its support function (Boyd & Vandenberghe, Convex Optimization, 2.2.1).

    Args:
        pairs: bodies and half-spaces.
        extents: of the bodies.
        places: (n, bodies, 3) positions of the bodies [m].
        turns: (n, bodies, 3, 3) their rotations.
    """
    columns: dict[int, list[int]] = {}
    for column, (body, _) in enumerate(pairs):
        columns.setdefault(body, []).append(column)
    gaps = np.empty((len(places), len(pairs)))
    for body, own in columns.items():
        normals = np.array([pairs[column][1].normal for column in own])
        offsets = np.array([pairs[column][1].offset for column in own])
        inward = normals @ turns[:, body]  # (n, own, 3), the normals as seen from the body
        reach = extents[body].along(-inward.reshape(-1, 3)).reshape(inward.shape[:2])
        gaps[:, own] = places[:, body] @ normals.T - offsets - reach
    return gaps
