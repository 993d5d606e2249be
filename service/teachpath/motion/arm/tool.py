"""Where the tool is: the tool centre point in the flange's frame, and the gripper that holds it.

The tool's z points out of the gripper, and its fingers close along y. Where the settings say no more than
`motion.tool_length`, the gripper sits on the flange, and the tool centre point lies on the axis of joint 6. Else
`motion.tool_position` and `motion.tool_orientation` give its pose, and the gripper sits `tool_length` behind it.
"""

from __future__ import annotations

from math import acos, degrees
from typing import Final

import numpy as np

from teachpath.errors import UnusableInput, UnusableSettings
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.rotations import rotation_matrices
from teachpath.motion.settings import MotionSettings
from teachpath.records import Quaternion, ToolPose
from teachpath.records.poses import unit_quaternion

NO_TURN: Final[Quaternion] = (1.0, 0.0, 0.0, 0.0)
MAX_OFFSET: Final = 0.5  # [m] of the tool centre point from the flange along each axis


def tool_of_settings(settings: MotionSettings) -> ToolPose | None:
    """Return the pose of the tool to the flange; None where the gripper sits on the flange, on the axis of joint 6.

    Raises:
        UnusableSettings: `motion.tool_position` is too far away or no position, `motion.tool_orientation` no rotation.
    """
    position = settings.tool_position or (0.0, 0.0, settings.tool_length)
    if len(position) != 3 or not all(abs(value) <= MAX_OFFSET for value in position):
        raise UnusableSettings(
            f"setting motion.tool_position is {list(position)}; write x, y, z of the tool centre point in the flange's "
            f"frame, each at most {MAX_OFFSET:g} m from it"
        )
    try:
        orientation = unit_quaternion(settings.tool_orientation or NO_TURN, "motion.tool_orientation")
    except UnusableInput as refusal:
        raise UnusableSettings(str(refusal)) from None
    x, y, z = (float(value) for value in position)
    straight = (x, y, z) == (0.0, 0.0, settings.tool_length) and orientation == NO_TURN
    return None if straight else ToolPose((x, y, z), orientation)


def tool_matrix(tool: ToolPose | None, tool_length: float) -> Array:
    """Return the pose (4, 4) to the flange from the tool; see `Arm` for both arguments."""
    pose = np.eye(4)
    pose[2, 3] = tool_length
    if tool is not None:
        pose[:3, :3] = rotation_matrices(np.array([tool.orientation]))[0]
        pose[:3, 3] = tool.position
    return pose


def describe_tool(tool: ToolPose | None, tool_length: float) -> str:
    """Describe where the tool centre point is, seen from the flange."""
    if tool is None:
        return f"a tool of {1e3 * tool_length:g} mm"
    place = ", ".join(f"{1e3 * value:.6g}" for value in tool.position)
    turn = degrees(2.0 * acos(min(abs(tool.orientation[0]), 1.0)))
    return (
        f"a tool at ({place}) mm from the flange, turned by {turn:.6g} deg, its gripper {1e3 * tool_length:g} mm long"
    )
