"""The kinematics by which joint angles of a file become a motion of the tool."""

from __future__ import annotations

from functools import partial

from teachpath.io.readers.joints import ToolKinematics
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm

PUMA_JOINTS = tuple(f"joint{number}" for number in range(1, 7))  # as trajectories of it are exported


def kinematics_of(arm: Arm) -> ToolKinematics:
    """Return the kinematics of an arm, with the names of its joints."""
    joints = PUMA_JOINTS if arm.model is None else tuple(joint.name for joint in arm.model.joints)
    return ToolKinematics(arm.name, joints, arm.limits.lower, arm.limits.upper, partial(tool_pose, arm=arm))
