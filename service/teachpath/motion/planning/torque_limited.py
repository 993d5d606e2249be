"""The fastest motion along a route that is within the motors' strength as well as within the joints' limits."""

from __future__ import annotations

from typing import Final

from teachpath.errors import PathRefused
from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.paths.ik_branches import Candidate
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.planning.certificate import largest_use
from teachpath.motion.planning.suggestion import name_control_point
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.timed_trajectory import time_joint_path
from teachpath.motion.timing.timing import time_tool_path
from teachpath.records import Extreme

TORQUE_STRIDE: Final = 8  # instant of a track is looked at for its torques
MAX_RETIMINGS: Final = 4  # times that a path is timed at most, each time with lower limits of acceleration
ACCELERATION_SAFETY_SHARE: Final = (
    0.97  # of the acceleration that the torques leave, because a slower path has other torques
)
MIN_ACCELERATION_SHARE: Final = 0.05  # of the limits of acceleration with which a path is still worth following


def time_within_torques(
    tool_path: ToolPath, candidate: Candidate, dynamics: Dynamics, settings: MotionSettings
) -> tuple[JointPath, Array, MotionLimits, Extreme]:
    """Time a route; where the limits of acceleration would ask too much of a motor, with lower ones.

    Returns:
        Joints and pace (see `timing.timed`), the limits they keep, and the largest use of a motor's torque.

    Raises:
        PathRefused: the motors are too weak however slow it goes, or no motion keeps the limits.
    """
    arm = candidate.branch.arm
    limits = arm.limits.motion.scaled(*[settings.path_share] * 3)
    for _ in range(MAX_RETIMINGS):
        joints, pace = time_tool_path(tool_path, candidate, limits, rate=settings.rate)
        rows = time_joint_path(joints, pace, limits).table[::TORQUE_STRIDE]
        q, velocity = rows[:, 0, :6], rows[:, 1, :6]
        worst = largest_use(dynamics.torque_bounds(q, velocity, limits.acceleration), rows[:, 0, 6], arm.limits.torque)
        if worst.value <= 1.0:
            return joints, pace, limits, worst
        left = dynamics.acceleration_share(q, velocity, limits.acceleration)
        if left < MIN_ACCELERATION_SHARE:
            break
        limits = limits.scaled(1.0, ACCELERATION_SAFETY_SHARE * left, 1.0)
    raise PathRefused(
        f"the motors would have to give {100 * worst.value:.0f} % of their torque at {worst.place}; carry less, or "
        f"bring the path nearer to the robot there, by {name_control_point(tool_path, worst.s)}"
    )
