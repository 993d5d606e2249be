"""Matrices of poses."""

from __future__ import annotations

from functools import cache

import numpy as np

from teachpath.motion.arm.rotations import rotation_matrices
from teachpath.records import Array, Pose, Quaternion


@cache
def pose_matrix(pose: Pose) -> Array:
    """Return the matrix (4, 4) of a pose, read-only."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation_matrices(np.array([pose[1]]))[0]
    matrix[:3, 3] = pose[0]
    matrix.flags.writeable = False
    return matrix


def turned(by: Quaternion, orientation: Quaternion) -> Quaternion:
    """Return an orientation turned by a rotation: the product of both quaternions."""
    w, x, y, z = by
    a, b, c, d = orientation
    return (
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b,
        w * d + x * c - y * b + z * a,
    )
