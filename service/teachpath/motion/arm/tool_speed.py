"""How fast the arm is in space: the speeds of elbow, wrist and tool centre point, which `motion.tool_speed` limits.

A point of a straight segment of a rigid body is never faster than the faster of the segment's ends. So the forearm,
between elbow and wrist, and the hand, between wrist and tool centre point, keep a limit that these points keep.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.motion.arm.kinematics import gripper_frame, link_frames
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.serial_kinematics import chain_length, joint_axes

# The points, each on z of a link or of the gripper: both ends of the elbow's axis, the wrist's centre, the tool's.
POINT_NAMES: Final = ("the elbow", "the elbow's outside", "the wrist", "the tool")
_LINKS: Final = (2, 2, 4, 6)
ELBOW_WIDTH: Final = 0.295  # m, along the elbow's axis from the shoulder's plane to the outer face of the upper arm
LINE_STEP: Final = 0.004  # rad, of the fastest joint between two samples of a straight line


def point_names(arm: Arm) -> tuple[str, ...]:
    """Return the names of the points; of a user's model, they are those on the axes of joints 2 and on, and the tool's.

    Link and link are then joined by segments between these points, as forearm and hand of the Puma 560 are.
    """
    if arm.model is None:
        return POINT_NAMES
    return (*(joint.name for joint in arm.model.joints[1:]), POINT_NAMES[-1])


def monitored_points(q: Array, arm: Arm) -> Array:
    """Return the positions (..., 4, 3) [m, world] of the points at configurations (..., joints)."""
    return _points(link_frames(q, arm), arm)


def point_speeds(q: Array, velocity: Array, arm: Arm) -> Array:
    """Return the speeds (n, 4) [m/s] of the points at configurations and joint velocities (n, joints)."""
    frames = link_frames(q, arm)
    if arm.model is None:
        axes, anchors, last = frames[:, :6, :3, 2], frames[:, :6, :3, 3], np.array(_LINKS) - 1
    else:
        axes, anchors = joint_axes(frames[:, 1:], arm.model)
        last = np.arange(len(arm.model.links))
    turning = velocity[:, :, None] * axes
    # The velocity of a point p on link k is the sum over its joints of w x (p - o).
    angular = np.cumsum(turning, axis=1)
    moment = np.cumsum(np.cross(turning, anchors), axis=1)
    return np.asarray(np.linalg.norm(np.cross(angular[:, last], _points(frames, arm)) - moment[:, last], axis=2))


def speed_bounds(motion: Array, step: float, arm: Arm) -> Array:
    """Return bounds (n, 4) [m/s]: between two samples, no point is faster than the larger of their bounds.

    Between the samples, a velocity f is off the line through them by step^2 / 8 times the largest |f''| at most, and
    on that line it is nowhere larger than at its ends. |f''| of a chain of rotations is bounded by the joints' rates.

    Args:
        motion: (n, 4, joints) joints and three derivatives at even samples.
        step: between two samples.
    """
    rate, second, third = (np.abs(motion[:, order]).sum(axis=1) for order in (1, 2, 3))
    return point_speeds(motion[:, 0], motion[:, 1], arm) + step**2 / 8.0 * _bend(rate, second, third, arm)


def cubic_speed_bound(states: Array, jerks: Array, step: float, arm: Arm) -> float:
    """Return an upper bound [m/s] of the points' speeds on a motion whose jerk is constant in every step.

    Args:
        states: (n + 1, 3, joints) joints, velocities and accelerations at the ends of the steps.
        jerks: (n, joints) sizes of the jerks in the steps [rad/s^3].
        step: [s].
    """
    third, second = jerks.sum(axis=1).max(), np.abs(states[:, 2]).sum(axis=1).max()
    rate = np.abs(states[:, 1]).sum(axis=1).max() + step / 2.0 * second  # no instant is farther from an end than that
    bend = _bend(rate, second, third, arm)
    return float(point_speeds(states[:, 0], states[:, 1], arm).max()) + step**2 / 8.0 * bend


def line_speed_bound(start: Array, direction: Array, turn: float, arm: Arm) -> float:
    """Return an upper bound of the points' speeds [m] on a straight line of the joints, per unit of its parameter.

    Args:
        start: configuration (joints,) [rad].
        direction: (joints,) of the joints by the parameter.
        turn: length of the line in its parameter.
    """
    count = int(np.ceil(turn / LINE_STEP)) + 1
    motion = np.zeros((count, 4, len(start)))
    motion[:, 0] = start + np.linspace(0.0, turn, count)[:, None] * direction
    motion[:, 1] = direction
    return float(speed_bounds(motion, turn / (count - 1), arm).max())


def squared_rate_ceiling(q: Array, slope: Array, tool_speed: float, arm: Arm) -> Array:
    """Return the largest square (n,) of a path parameter's rate at which the points keep a speed [m/s].

    Args:
        q: (n, joints) configurations on the path.
        slope: (n, joints) their derivative by the parameter.
    """
    if np.isinf(tool_speed):
        return np.full(len(q), np.inf)
    return np.asarray((tool_speed / np.maximum(point_speeds(q, slope, arm).max(axis=1), 1e-12)) ** 2)


def difference_speeds(setpoints: Array, rate: float, arm: Arm) -> Array:
    """Return the speeds (n - 1, 4) [m/s] of the points by differences of setpoints (n, joints) at a rate [Hz]."""
    moves = np.diff(monitored_points(setpoints[:, : arm.joint_count], arm), axis=0)
    return np.asarray(np.linalg.norm(moves, axis=2) * rate)


def _points(frames: Array, arm: Arm) -> Array:
    if arm.model is not None:
        tool = frames[..., -1, :, :] @ arm.tool_matrix
        anchors = joint_axes(frames[..., 1:, :, :], arm.model)[1]
        return np.concatenate([anchors[..., 1:, :], tool[..., None, :3, 3]], axis=-2)
    offsets = np.array([0.0, ELBOW_WIDTH, 0.0, arm.tool_length])[:, None]
    on_links = frames[..., list(_LINKS), :, :]
    on_links[..., 3, :, :] = gripper_frame(on_links[..., 3, :, :], arm)
    return np.asarray(on_links[..., :3, 3] + offsets * on_links[..., :3, 2])


def _bend(rate: Array, second: Array, third: Array, arm: Arm) -> float:
    """Bound the second derivative of a point's velocity by sums of the joints' derivatives."""
    return _reach(arm) * float(np.max(rate**3 + 3.0 * rate * second + third))


def _reach(arm: Arm) -> float:
    """Return a length [m] that no point is farther away from any joint's axis than; joint 1 turns about the column."""
    if arm.model is not None:
        return chain_length(arm.model)
    links = sum(float(np.hypot(link.a, link.d)) for link in arm.links[1:])
    return links + max(arm.tool_reach, ELBOW_WIDTH)
