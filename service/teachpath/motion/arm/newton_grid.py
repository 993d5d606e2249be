"""Configurations of an arm with seven joints on a grid of poses and angles of one joint (compiled; see `newton`)."""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.motion.arm.newton import approach_pose, kernel
from teachpath.records import Array

MAX_CHANGE: Final = 1.0  # rad, of a joint from a place of the grid to the next; a larger one leads to another branch


@kernel
def fill_row(
    pose: Array, angles: Array, joint: int, before: Array, begin: int, turns: Array, axes: Array, anchors: Array,
    tool: Array, iterations: int, residual: float, closed: float, found: Array, off: Array,
) -> None:  # fmt: skip
    """Bring the tool to one pose with a joint at each of its angles, from the configurations of the row before.

    An angle from which the row before does not lead here is reached from its neighbours, where these are closed.

    Args:
        pose: (4, 4) to world from the tool.
        angles: (k,) of the joint [rad].
        joint: number of the joint.
        before: (k, joints) of the row before [rad].
        begin: the only angle that `before` has; -1: it has all.
        closed: distance from the pose [m and rad] within which it is met.
        found: (k, joints) where the configurations are written [rad].
        off: (k,) where their distances from the pose are written.
    """
    count = len(angles)
    off[:] = np.inf
    usable = closed if begin < 0 else 1e9  # distance of a neighbour that is begun from
    for column in range(count):
        if begin < 0 or column == begin:
            given = (turns, axes, anchors, tool, iterations, residual, column, found, off)
            _reach(pose, before[column], angles[column], joint, *given)
    for step in (1, -1):
        for k in range(1, count):
            column = k if step == 1 else count - 1 - k
            if off[column] > closed and off[column - step] <= usable:
                given = (turns, axes, anchors, tool, iterations, residual, column, found, off)
                _reach(pose, found[column - step], angles[column], joint, *given)


@kernel
def _reach(
    pose: Array, seed: Array, angle: float, joint: int, turns: Array, axes: Array, anchors: Array, tool: Array,
    iterations: int, residual: float, column: int, found: Array, off: Array,
) -> None:  # fmt: skip
    """Write the configuration that Newton's method finds from a seed, unless it is farther off than the one there."""
    q = seed.copy()
    q[joint] = angle
    distance = approach_pose(pose, q, turns, axes, anchors, tool, iterations, residual, joint)
    for i in range(len(q)):
        if i != joint and abs(q[i] - seed[i]) > MAX_CHANGE:
            distance = max(distance, MAX_CHANGE)
    if distance < off[column]:
        off[column] = distance
        found[column] = q
