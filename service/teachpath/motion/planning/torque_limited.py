"""The fastest motion along a route that is within the motors' strength as well as within the joints' limits."""

from __future__ import annotations

from typing import Final

from teachpath.errors import PathRefused
from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.joint_path import ARM, JointPath, Limits
from teachpath.motion.arm.puma560 import TORQUE, Array
from teachpath.motion.paths.ik_branches import Candidate
from teachpath.motion.paths.tool_path import Route
from teachpath.motion.planning.certificate import largest_use
from teachpath.motion.planning.suggestion import nearest_point
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.timed_trajectory import paced
from teachpath.motion.timing.timing import timed
from teachpath.records import Extreme

EVERY: Final = 8  # instant of a track is looked at for its torques
SLOWER: Final = 4  # times that a path is timed at most, each time with lower limits of acceleration
LESS: Final = 0.97  # of the acceleration that the torques leave, because a slower path has other torques
LEAST_LEFT: Final = 0.05  # of the limits of acceleration with which a path is still worth following


def within_torques(
    way: Route, candidate: Candidate, dynamics: Dynamics, settings: MotionSettings
) -> tuple[JointPath, Array, Limits, Extreme]:
    """Time a route; where the limits of acceleration would ask too much of a motor, with lower ones.

    Returns:
        Joints and pace (see `timing.timed`), the limits they keep, and the largest use of a motor's torque.

    Raises:
        PathRefused: the motors are too weak however slow it goes, or no motion keeps the limits.
    """
    limits = ARM.scaled(*[settings.path_share] * 3)
    for _ in range(SLOWER):
        joints, pace = timed(way, candidate, limits, rate=settings.rate)
        rows = paced(joints, pace, limits).table[::EVERY]
        q, velocity = rows[:, 0, :6], rows[:, 1, :6]
        worst = largest_use(dynamics.largest(q, velocity, limits.acceleration), rows[:, 0, 6], TORQUE)
        if worst.value <= 1.0:
            return joints, pace, limits, worst
        left = dynamics.share_left(q, velocity, limits.acceleration)
        if left < LEAST_LEFT:
            break
        limits = limits.scaled(1.0, LESS * left, 1.0)
    raise PathRefused(
        f"the motors would have to give {100 * worst.value:.0f} % of their torque at {worst.place}; carry less, or "
        f"bring the path nearer to the robot there, by {nearest_point(way, worst.s)}"
    )
