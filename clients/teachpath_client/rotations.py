"""Rotations as unit quaternions w, x, y, z."""

from __future__ import annotations

import math

from teachpath_client.reading import Quaternion, Vector

Matrix = tuple[Vector, Vector, Vector]  # rows


def unit(turn: Quaternion) -> Quaternion:
    """Return a quaternion with length 1."""
    length = math.hypot(*turn)
    w, x, y, z = (part / length for part in turn)
    return w, x, y, z


def product(a: Quaternion, b: Quaternion) -> Quaternion:
    """Return the rotation that turns by `b`, then by `a`."""
    w, x, y, z = a
    s, i, j, k = b
    return (
        w * s - x * i - y * j - z * k,
        w * i + x * s + y * k - z * j,
        w * j - x * k + y * s + z * i,
        w * k + x * j - y * i + z * s,
    )


def turned(turn: Quaternion, vector: Vector) -> Vector:
    """Return a vector turned by a unit quaternion."""
    w, x, y, z = turn
    _, i, j, k = product(product(turn, (0.0, *vector)), (w, -x, -y, -z))
    return i, j, k


def rotation(vector: Vector) -> Quaternion:
    """Return the rotation about the axis of a vector, by its length [rad]."""
    angle = math.hypot(*vector)
    share = math.sin(0.5 * angle) / angle if angle > 0.0 else 0.0
    x, y, z = (share * part for part in vector)
    return math.cos(0.5 * angle), x, y, z


def of_matrix(matrix: Matrix) -> Quaternion:
    """Return the rotation of a matrix, given by rows, by the largest of its four numbers (Shepperd 1978)."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    squares = (1.0 + a + e + i, 1.0 + a - e - i, 1.0 - a + e - i, 1.0 - a - e + i)  # four times w, x, y, z squared
    products = (
        (squares[0], h - f, c - g, d - b),
        (h - f, squares[1], b + d, c + g),
        (c - g, b + d, squares[2], f + h),
        (d - b, c + g, f + h, squares[3]),
    )
    return unit(products[max(range(4), key=squares.__getitem__)])
