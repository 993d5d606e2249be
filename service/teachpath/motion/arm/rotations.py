"""Rotation matrices of unit quaternions."""

from __future__ import annotations

import numpy as np

from teachpath.motion.arm.puma560 import Array


def rotation_matrices(quaternions: Array) -> Array:
    """Return the rotation matrices (m, 3, 3) of unit quaternions (m, 4), w first."""
    w, x, y, z = quaternions.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)
