"""Times a path: the fastest motion within the joints' limits that is within the motors' torques as well."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.errors import PathRefused
from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.paths.ik_branches import Candidate
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.joint_moves import straight_move
from teachpath.motion.timing.limit_margins import SYMMETRIC_MARGINS, largest_use
from teachpath.motion.timing.timed_trajectory import TimedTrajectory, time_joint_path
from teachpath.motion.timing.timing import time_tool_path
from teachpath.records import Extreme

TORQUE_STRIDE: Final = 8  # rows of a trajectory's table from one torque check to the next
MAX_RETIMINGS: Final = 4  # timings of a path at most, each with lower acceleration limits than the one before
# Share of the acceleration that the torques leave; less than all of it, because a slower path has other torques.
ACCELERATION_SAFETY_SHARE: Final = 0.97
MOVE_SAMPLES: Final = 25  # of a straight move, at which its torques are bounded
MIN_ACCELERATION_SHARE: Final = 0.05  # of the acceleration limits, with which a path is still worth following


@dataclass(frozen=True, eq=False)
class TimedPath:
    """How the joints follow a path over time.

    Attributes:
        joints: by a parameter from 0 to 1.
        squared_rates: coefficients of the parameter's squared rate (see `timed_trajectory.time_joint_path`) [1/s^2].
        limits: that the motion keeps.
        trajectory: the motion at full speed.
        torque_use: the largest use of a motor's torque.
    """

    joints: JointPath
    squared_rates: Array
    limits: MotionLimits
    trajectory: TimedTrajectory
    torque_use: Extreme


def time_within_torques(
    tool_path: ToolPath, candidate: Candidate, dynamics: Dynamics, settings: MotionSettings
) -> TimedPath:
    """Time a path; where a motor would need more torque than it has, time it again with lower acceleration limits.

    Raises:
        PathRefused: the motors are too weak at any speed, no motion keeps the limits, or the tool leaves the path.
    """
    arm = candidate.branch.arm
    limits = arm.limits.motion.scaled(*[settings.path_share] * 3)
    for _ in range(MAX_RETIMINGS):
        joints, squared_rates = time_tool_path(tool_path, candidate, limits, rate=settings.rate)
        trajectory = time_joint_path(joints, squared_rates, limits)
        rows = trajectory.table[::TORQUE_STRIDE]
        q, velocity = rows[:, 0, :-1], rows[:, 1, :-1]
        bounds = dynamics.torque_bounds(q, velocity, limits.acceleration)
        worst = largest_use(bounds, rows[:, 0, -1], arm.limits.names, arm.limits.torque)
        if worst.value <= 1.0:
            _check_tolerance(tool_path, joints, arm, settings)
            return TimedPath(joints, squared_rates, limits, trajectory, worst)
        left = dynamics.acceleration_share(q, velocity, limits.acceleration)
        if left < MIN_ACCELERATION_SHARE:
            break
        limits = limits.scaled(1.0, ACCELERATION_SAFETY_SHARE * left, 1.0)
    move = tool_path.describe_control_point(worst.s)
    raise PathRefused(
        f"the motors would have to give {100 * worst.value:.0f} % of their torque at {worst.place}; carry less"
        f"{_load_hint(arm, dynamics)}, or bring the path nearer to the robot there, by {move}"
    )


def move_within_torques(
    start: Array, goal: Array, limits: MotionLimits, dynamics: Dynamics, arm: Arm, move_name: str
) -> TimedTrajectory:
    """Time a straight move of the joints with accelerations that are within the motors' torques everywhere on it.

    Args:
        start: configuration (joints,) [rad].
        goal: configuration (joints,) [rad].
        limits: to keep.
        dynamics: of the arm with its payload and what it carries.
        arm: that moves.
        move_name: of the move, for the error.

    Raises:
        PathRefused: the motors are too weak at any speed.
    """
    line = start + np.linspace(0.0, 1.0, MOVE_SAMPLES)[:, None] * (goal - start)
    direction = np.abs(goal - start) / np.abs(goal - start).max()
    speed = direction * float(np.min(limits.speed / np.maximum(direction, 1e-12)))
    left = dynamics.acceleration_share(line, np.tile(speed, (MOVE_SAMPLES, 1)), limits.acceleration)
    if left < MIN_ACCELERATION_SHARE:
        raise PathRefused(
            f"{move_name}: the motors are too weak for what the arm carries; carry less{_load_hint(arm, dynamics)}"
        )
    limits = limits.scaled(1.0, min(1.0, ACCELERATION_SAFETY_SHARE * left), 1.0)
    return straight_move(start, goal, limits, arm=arm, margins=SYMMETRIC_MARGINS)


def _load_hint(arm: Arm, dynamics: Dynamics) -> str:
    """Return the mass of the heavier of both, the payload and the object."""
    if dynamics.carried_mass > arm.payload.mass:
        return f" (the object has {dynamics.carried_mass:.3g} kg)"
    return f" (motion.payload_mass is {arm.payload.mass:g} kg)" if arm.payload.mass else ""


def _check_tolerance(tool_path: ToolPath, joints: JointPath, arm: Arm, settings: MotionSettings) -> None:
    """Check that the tool stays within the path's tolerance between the nodes of the joints' spline."""
    reached = joints(joints.dense_parameters())
    wanted = tool_path.poses(tool_path.arc.parameters(reached[:, -1]))[:, :3, 3]
    off = np.linalg.norm(tool_pose(reached[:, :-1], arm)[:, :3, 3] - wanted, axis=1)
    worst = int(np.argmax(off))
    if off[worst] > settings.path_tolerance:
        s = float(reached[worst, -1])
        node = int(np.argmin(np.abs(tool_path.lengths - s)))
        raise PathRefused(
            f"the path bends too sharply to be followed within its tolerance {tool_path.describe_node(node)}; "
            f"move {tool_path.describe_control_point(s)}"
        )
