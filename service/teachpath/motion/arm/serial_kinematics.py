"""Forward kinematics and Jacobian of an arm that a user's model describes, for any number of joints."""

from __future__ import annotations

from functools import cache

import numpy as np

from teachpath.motion.arm.poses import pose_matrix
from teachpath.records import Array, RevoluteJoint, SerialArm, Vector


def serial_link_frames(q: Array, arm: SerialArm) -> Array:
    """Return the poses (..., joints, 4, 4) to world from the links at configurations (..., joints) [rad]."""
    frame = np.broadcast_to(pose_matrix(arm.base), (*np.shape(q)[:-1], 4, 4))
    frames = []
    for number, link in enumerate(arm.links):
        frame = frame @ pose_matrix(link.pose) @ _turned(q[..., number], link.joint)
        frames.append(frame)
    return np.stack(frames, axis=-3)


def serial_tool_pose(q: Array, arm: SerialArm) -> Array:
    """Return the poses (..., 4, 4) to world from the tool at configurations (..., joints) [rad]."""
    return np.asarray(serial_link_frames(q, arm)[..., -1, :, :] @ pose_matrix(arm.tool))


def serial_jacobian(q: Array, arm: SerialArm) -> Array:
    """Return the tool's Jacobian (..., 6, joints) at configurations (..., joints): velocity, then angular velocity.

    Siciliano et al., Robotics, Springer 2009, eq. (3.30): joint i turns the tool about its axis.
    """
    frames = serial_link_frames(q, arm)
    tool = (frames[..., -1, :, :] @ pose_matrix(arm.tool))[..., None, :3, 3]
    axes, anchors = joint_axes(frames, arm)
    return np.swapaxes(np.concatenate([np.cross(axes, tool - anchors), axes], axis=-1), -1, -2)


def joint_axes(frames: Array, arm: SerialArm) -> tuple[Array, Array]:
    """Return axes and points on them (..., joints, 3) in the world, from the links' frames (..., joints, 4, 4)."""
    turns = frames[..., :3, :3]
    axes, anchors = (np.array([getattr(joint, name) for joint in arm.joints]) for name in ("axis", "anchor"))
    return (turns @ axes[..., None])[..., 0], (turns @ anchors[..., None])[..., 0] + frames[..., :3, 3]


def chain_length(arm: SerialArm) -> float:
    """Return a length [m] than which no point of the axes and no tool is farther from any other axis."""
    links = sum(_norm(link.pose[0]) + 2.0 * _norm(link.joint.anchor) for link in arm.links[1:])
    return links + _norm(arm.tool[0]) + 2.0 * _norm(arm.joints[0].anchor)


def lever_arms(radii: Array, arm: SerialArm) -> Array:
    """Return bounds (k,) [m] on the distance of any point that joints move to their axes, in any configuration.

    Args:
        radii: (k,) within which the points of the first links lie around the origin of each link's frame [m].
        arm: whose links they are.
    """
    arms, far = np.zeros(len(radii)), 0.0  # far: from a link's origin to any point that its joint moves
    for number in range(len(radii) - 1, -1, -1):
        link = arm.links[number]
        far = max(far, float(radii[number]))
        arms[number] = far + _norm(link.joint.anchor)
        # A link turns about its anchor, so that its origin moves by twice the anchor's distance at most.
        far += _norm(link.pose[0]) + 2.0 * _norm(link.joint.anchor)
    return arms


def _turned(angle: Array, joint: RevoluteJoint) -> Array:
    """Return the motions (..., 4, 4) of a link by angles (...,) about its joint's axis (Rodrigues' formula)."""
    constant, by_sine, by_cosine = _turn_terms(joint.axis, joint.anchor)
    return np.asarray(constant + np.sin(angle)[..., None, None] * by_sine + np.cos(angle)[..., None, None] * by_cosine)


@cache
def _turn_terms(axis: Vector, anchor: Vector) -> tuple[Array, Array, Array]:
    """Return what turns about an axis are made of, (4, 4) each: a constant, factors of the angle's sine and cosine."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    constant, by_sine, by_cosine = np.eye(4), np.zeros((4, 4)), np.zeros((4, 4))
    constant[:3, :3] += cross @ cross
    by_sine[:3, :3], by_cosine[:3, :3] = cross, -cross @ cross
    for term in (constant, by_sine, by_cosine):
        term[:3, 3] = -term[:3, :3] @ anchor
    constant[:3, 3] += anchor
    return constant, by_sine, by_cosine


def _norm(vector: Vector) -> float:
    return float(np.linalg.norm(vector))
