"""Poses as position and quaternion, and where an arm's tool is."""

from __future__ import annotations

import math
from collections.abc import Mapping

from teachpath_client.models import Robot
from teachpath_client.reading import Quaternion, Vector
from teachpath_client.rotations import product, turned

Pose = tuple[Vector, Quaternion]  # to parent from child: position, and a unit quaternion w, x, y, z


def composed(outer: Pose, inner: Pose) -> Pose:
    """Return the pose of a frame in the frame of another, whose pose is `outer`."""
    (x, y, z), turn = outer
    dx, dy, dz = turned(turn, inner[0])
    return (x + dx, y + dy, z + dz), product(turn, inner[1])


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
