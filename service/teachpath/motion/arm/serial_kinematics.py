"""Forward kinematics and Jacobian of an arm that a user's model describes, for any number of joints."""

from __future__ import annotations

from functools import cache

import numpy as np

from teachpath.motion.arm.poses import pose_matrix
from teachpath.records import Array, Pose, SerialArm, SerialLink, Vector


def serial_link_frames(q: Array, arm: SerialArm) -> Array:
    """Return the poses (..., joints, 4, 4) to world from the links at configurations (..., joints) [rad]."""
    q = np.asarray(q, dtype=np.float64)
    sine, cosine = np.sin(q)[..., None, None], np.cos(q)[..., None, None]
    frames, frame = np.empty((*q.shape, 4, 4)), pose_matrix(arm.base)
    for number, link in enumerate(arm.links):
        constant, by_sine, by_cosine = link_terms(link)
        turned = constant + sine[..., number, :, :] * by_sine + cosine[..., number, :, :] * by_cosine
        frame = frames[..., number, :, :] = frame @ turned
    return frames


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


def link_terms(link: SerialLink) -> Array:
    """Return what a link's motion to the one before is made of (Rodrigues' formula).

    Returns:
        (3, 4, 4) a constant, factor of the angle's sine, factor of its cosine; read-only.
    """
    return _link_terms(link.pose, link.joint.axis, link.joint.anchor)


@cache
def _link_terms(pose: Pose, axis: Vector, anchor: Vector) -> Array:
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    constant, by_sine, by_cosine = np.eye(4), np.zeros((4, 4)), np.zeros((4, 4))
    constant[:3, :3] += cross @ cross
    by_sine[:3, :3], by_cosine[:3, :3] = cross, -cross @ cross
    for term in (constant, by_sine, by_cosine):
        term[:3, 3] = -term[:3, :3] @ anchor
    constant[:3, 3] += anchor
    terms = pose_matrix(pose) @ np.stack([constant, by_sine, by_cosine])
    terms.flags.writeable = False
    return np.asarray(terms)


def _norm(vector: Vector) -> float:
    return float(np.linalg.norm(vector))
