"""Poses as position and quaternion, and where an arm's tool is."""

from __future__ import annotations

import math
from collections.abc import Mapping

from teachpath_client.models import Robot
from teachpath_client.reading import Quaternion, Vector

Pose = tuple[Vector, Quaternion]  # to parent from child: position, and a unit quaternion w, x, y, z


def composed(outer: Pose, inner: Pose) -> Pose:
    """Return the pose of a frame in the frame of another, whose pose is `outer`."""
    (x, y, z), turn = outer
    dx, dy, dz = turned(turn, inner[0])
    return (x + dx, y + dy, z + dz), product(turn, inner[1])


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


def tool_pose(robot: Robot, angles: Mapping[str, float]) -> Pose:
    """Return the pose of an arm's tool in the world.

    Args:
        robot: as the station describes it.
        angles: of the joints, by their names [rad].
    """
    pose: Pose = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
    for joint in robot.joints:
        half = 0.5 * angles[joint_name(joint.name)]
        i, j, k = (math.sin(half) * part for part in joint.axis)
        turn = (math.cos(half), i, j, k)
        # About the axis through the anchor: the anchor stays where it is.
        ax, ay, az = joint.anchor
        tx, ty, tz = turned(turn, joint.anchor)
        moved = composed((joint.position, joint.orientation), ((ax - tx, ay - ty, az - tz), turn))
        pose = composed(pose, moved)
    return composed(pose, (robot.tool.position, robot.tool.orientation))


def joint_name(name: str) -> str:
    """Return a joint's name as in the arm's URDF or MJCF model: without spaces."""
    return name.replace(" ", "")
