"""Newton's method of numeric inverse kinematics (compiled): many poses, each from a configuration of its own."""

from __future__ import annotations

from collections.abc import Callable
from math import atan2, cos, sin, sqrt
from typing import Final

import numpy as np

from teachpath.compiled import F, compiled
from teachpath.records import Array

MAX_STEP: Final = 0.5  # rad, of a joint in one iteration
DAMPING: Final = 0.05  # of the squared error, by which steps near singular configurations stay small
HALF_TURN: Final = 1e-6  # sine of a turn below which, near a half turn, its axis is read from the matrix's columns

kernel: Callable[[F], F] = compiled(error_model="numpy")  # which lets a division by zero give what it gives in numpy


@kernel
def approach_poses(
    poses: Array, seeds: Array, turns: Array, axes: Array, anchors: Array, tool: Array, iterations: int,
    residual: float, held: int,
) -> Array:  # fmt: skip
    """Return the configurations (n, joints) [rad] nearest to poses that Newton's method finds from seeds.

    Args:
        poses: (n, 4, 4) to world from the tool.
        seeds: (n, joints) configurations to begin at [rad].
        turns: (joints, 3, 4, 4) what the motion of each link to the one before is made of: a constant, factors of the
            angle's sine and cosine.
        axes: (joints, 3) of the joints, in the frames of their links.
        anchors: (joints, 3) points on them [m].
        tool: (4, 4) to the last link from the tool.
        iterations: at most.
        residual: distance from the pose [m and rad] at which no more are made.
        held: number of a joint that keeps its angle; -1: none does.
    """
    found = seeds.copy()
    for row in range(len(seeds)):
        approach_pose(poses[row], found[row], turns, axes, anchors, tool, iterations, residual, held)
    return found


@kernel
def approach_pose(
    pose: Array, q: Array, turns: Array, axes: Array, anchors: Array, tool: Array, iterations: int, residual: float,
    held: int,
) -> float:  # fmt: skip
    """Bring a configuration (joints,) as near to a pose (4, 4) as `approach_poses` does; return its distance."""
    count, least = len(q), np.inf
    error, jacobian, step = np.empty(6), np.empty((6, count)), np.empty(count)
    trial, frames, reached = q.copy(), np.empty((count, 4, 4)), np.empty((4, 4))
    for _ in range(iterations + 1):
        _place_links(trial, turns, frames)
        _write_product(frames[count - 1], tool, reached)
        off = _write_error(pose, reached, error)
        if off < least:
            least = off
            for joint in range(count):
                q[joint] = trial[joint]
        if off <= residual:
            break
        _write_jacobian(frames, axes, anchors, reached, jacobian)
        if held >= 0:
            for i in range(6):
                jacobian[i, held] = 0.0
        _write_step(jacobian, error, step)
        for joint in range(count):
            trial[joint] += step[joint]
    return least


@kernel
def _place_links(q: Array, turns: Array, frames: Array) -> None:
    """Write the poses of the links in the world to `frames` (joints, 4, 4)."""
    first, link = np.eye(4), np.empty((4, 4))
    for joint in range(len(q)):
        s, c = sin(q[joint]), cos(q[joint])
        for i in range(4):
            for j in range(4):
                link[i, j] = turns[joint, 0, i, j] + s * turns[joint, 1, i, j] + c * turns[joint, 2, i, j]
        _write_product(frames[joint - 1] if joint else first, link, frames[joint])


@kernel
def _write_product(a: Array, b: Array, out: Array) -> None:
    """Write the product of two motions (4, 4)."""
    for i in range(4):
        for j in range(4):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j] + a[i, 3] * b[3, j]


@kernel
def _write_jacobian(frames: Array, axes: Array, anchors: Array, reached: Array, jacobian: Array) -> None:
    """Write the Jacobian (6, joints) of a tool at the pose `reached` (4, 4), from the links' frames."""
    axis, lever = np.empty(3), np.empty(3)
    for joint in range(len(frames)):
        frame, a, p = frames[joint], axes[joint], anchors[joint]
        for i in range(3):
            axis[i] = frame[i, 0] * a[0] + frame[i, 1] * a[1] + frame[i, 2] * a[2]
            lever[i] = reached[i, 3] - frame[i, 3] - frame[i, 0] * p[0] - frame[i, 1] * p[1] - frame[i, 2] * p[2]
            jacobian[3 + i, joint] = axis[i]
        jacobian[0, joint] = axis[1] * lever[2] - axis[2] * lever[1]
        jacobian[1, joint] = axis[2] * lever[0] - axis[0] * lever[2]
        jacobian[2, joint] = axis[0] * lever[1] - axis[1] * lever[0]


@kernel
def _write_error(wanted: Array, reached: Array, error: Array) -> float:
    """Write what moves and turns the tool to a wanted pose (4, 4) to `error` (6,); return the larger of [m], [rad]."""
    turn = np.empty((3, 3))
    for i in range(3):
        error[i] = wanted[i, 3] - reached[i, 3]
        for j in range(3):
            turn[i, j] = wanted[i, 0] * reached[j, 0] + wanted[i, 1] * reached[j, 1] + wanted[i, 2] * reached[j, 2]
    error[3] = (turn[2, 1] - turn[1, 2]) / 2.0
    error[4] = (turn[0, 2] - turn[2, 0]) / 2.0
    error[5] = (turn[1, 0] - turn[0, 1]) / 2.0
    sine = sqrt(error[3] ** 2 + error[4] ** 2 + error[5] ** 2)
    cosine = (turn[0, 0] + turn[1, 1] + turn[2, 2] - 1.0) / 2.0
    angle = atan2(sine, cosine)
    if cosine < 0.0 and sine < HALF_TURN:  # R + 1 is then twice the product of the axis with itself
        column = 0
        for i in range(1, 3):
            if turn[i, i] > turn[column, column]:
                column = i
        for i in range(3):
            error[3 + i] = turn[i, column] + (1.0 if i == column else 0.0)
        sine = sqrt(error[3] ** 2 + error[4] ** 2 + error[5] ** 2)
    if sine > 0.0:
        for i in range(3, 6):
            error[i] *= angle / sine
    return max(sqrt(error[0] ** 2 + error[1] ** 2 + error[2] ** 2), angle)


@kernel
def _write_step(jacobian: Array, error: Array, step: Array) -> None:
    """Write damped least squares' step (joints,) for an error (6,), cut to `MAX_STEP` (Siciliano et al., eq. 3.59).

    The damped square of the Jacobian (6, joints) is factored after Cholesky.
    """
    damping = 1e-15
    for i in range(6):
        damping += DAMPING * error[i] ** 2
    lower, y = np.zeros((6, 6)), np.empty(6)
    for i in range(6):
        y[i] = error[i]
        for j in range(i + 1):
            total = damping if i == j else 0.0
            for k in range(len(step)):
                total += jacobian[i, k] * jacobian[j, k]
            for k in range(j):
                total -= lower[i, k] * lower[j, k]
            lower[i, j] = sqrt(max(total, 1e-30)) if i == j else total / lower[j, j]
        for k in range(i):
            y[i] -= lower[i, k] * y[k]
        y[i] /= lower[i, i]
    for i in range(5, -1, -1):
        for k in range(i + 1, 6):
            y[i] -= lower[k, i] * y[k]
        y[i] /= lower[i, i]
    largest = 1e-12
    for k in range(len(step)):
        step[k] = 0.0
        for i in range(6):
            step[k] += jacobian[i, k] * y[i]
        largest = max(largest, abs(step[k]))
    for k in range(len(step)):
        step[k] *= min(1.0, MAX_STEP / largest)


@kernel
def turn_wrists(
    before: Array, orientations: Array, begin: Array, turns: Array, axes: Array, anchors: Array, tool: Array,
    iterations: int, residual: float, out: Array,
) -> float:  # fmt: skip
    """Write the last three joints (n, 3) that give the tool its orientations; return the largest angle left [rad].

    Args:
        before: (n, joints - 3) angles of the joints before [rad].
        orientations: (n, 3, 3) to world from the tool.
        begin: (joints,) configuration before the first, from which Newton's method begins; then it goes on from each.
        turns: see `approach_poses`, as all that follow.
    """
    count = len(begin)
    lead, largest = count - 3, 0.0
    error, jacobian, step = np.empty(6), np.empty((6, count)), np.empty(count)
    q, frames, reached, wanted = begin.copy(), np.empty((count, 4, 4)), np.empty((4, 4)), np.empty((4, 4))
    for row in range(len(before)):
        q[:lead] = before[row]
        off = np.inf
        for _ in range(iterations):
            _place_links(q, turns, frames)
            _write_product(frames[count - 1], tool, reached)
            wanted[:, 3] = reached[:, 3]  # only the turn is asked for
            wanted[:3, :3] = orientations[row]
            off = _write_error(wanted, reached, error)
            if off <= residual:
                break
            _write_jacobian(frames, axes, anchors, reached, jacobian)
            jacobian[:3] = 0.0
            jacobian[:, :lead] = 0.0
            _write_step(jacobian, error, step)
            for joint in range(lead, count):
                q[joint] += step[joint]
        out[row] = q[lead:]
        largest = max(largest, off)
    return largest
