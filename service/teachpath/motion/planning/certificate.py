"""Certifies a plan: measures how much of each limit its setpoints use."""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.errors import PathRefused
from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.limits import JointLimits, MotionLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.tool_speed import point_names
from teachpath.motion.paths.ik_branches import Candidate
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.planning.torque_limited import TimedPath
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.limit_margins import largest_use, limit_uses
from teachpath.motion.timing.timed_trajectory import SPEED_STRIDE, TimedTrajectory, time_joint_path
from teachpath.records import Certificate, Extreme, LimitSource, Plan

LIMIT_KINDS: Final = ("lower", "upper", "speed", "acceleration", "jerk", "torque")


def plan_trajectory(plan: Plan) -> TimedTrajectory:
    """Return the motion of a plan along its path at full speed; it is the same wherever it is computed."""
    path = JointPath(np.linspace(0.0, 1.0, len(plan.lengths)), plan.lengths, plan.joints)
    tool_speed = np.inf if plan.tool_speed is None else plan.tool_speed
    speed, acceleration, jerk = plan.limits
    return time_joint_path(path, plan.squared_rates, MotionLimits(speed, acceleration, jerk, tool_speed))


def certify(
    tool_path: ToolPath, candidate: Candidate, timed: TimedPath, clearance: Extreme, settings: MotionSettings
) -> Certificate:
    """Measure how much of the limits the setpoints of a path use; the digest is left empty.

    Args:
        tool_path: what the tool follows.
        candidate: the branch and roll of the tool.
        timed: how the joints follow it.
        clearance: what was proved.
        settings: what may be used.

    Raises:
        PathRefused: the setpoints use more than that.
    """
    setpoints = timed.trajectory.setpoints(settings.rate)
    position, velocity, acceleration, jerk = largest_limit_uses(setpoints, settings.rate, candidate.branch.arm.limits)
    worst = max((velocity, acceleration, jerk), key=lambda extreme: extreme.value)
    if worst.value > settings.path_share:
        raise PathRefused(
            f"a limit is used to {100 * worst.value:.1f} % by {worst.place}, at most "
            f"{100 * settings.path_share:.1f} %; smooth the path there: "
            f"move {tool_path.describe_control_point(worst.s)}"
        )
    arm = candidate.branch.arm
    speed = largest_speed(timed.trajectory, arm)
    if speed.value > arm.limits.tool_speed:
        raise PathRefused(
            f"{speed.place} would move at {speed.value:.3f} m/s, limit {arm.limits.tool_speed:g} "
            f"(motion.tool_speed); smooth the path there: move {tool_path.describe_control_point(speed.s)}"
        )
    singular_s = float(tool_path.lengths[int(np.argmin(candidate.singular_values))])
    return Certificate(
        digest="",
        branch=candidate.description + _limit_sources(arm),
        position_use=position,
        velocity_use=velocity,
        acceleration_use=acceleration,
        jerk_use=jerk,
        torque_use=timed.torque_use,
        tool_speed=speed,
        least_singular=Extreme(candidate.min_singular_value, f"s = {singular_s:.3f} m", singular_s),
        clearance=clearance,
    )


def largest_speed(trajectory: TimedTrajectory, arm: Arm) -> Extreme:
    """Return the largest speed [m/s] of elbow, wrist and tool on a trajectory, proved between its rows too."""
    bounds = trajectory.speed_bounds(arm)
    row, point = np.unravel_index(int(np.argmax(bounds)), bounds.shape)
    s = float(trajectory.table[min(int(row) * SPEED_STRIDE, len(trajectory.table) - 1), 0, -1])
    return Extreme(float(bounds[row, point]), f"{point_names(arm)[point]} at s = {s:.3f} m", s)


def largest_limit_uses(setpoints: Array, rate: float, limits: JointLimits) -> tuple[Extreme, Extreme, Extreme, Extreme]:
    """Measure how much of the joints' position, speed, acceleration and jerk limits setpoints use.

    Args:
        setpoints: (n, joints + 1) joints [rad] and where on the path each lies [m].
        rate: setpoints a second [Hz].
        limits: of the joints.
    """
    middle, half = (limits.lower + limits.upper) / 2, (limits.upper - limits.lower) / 2
    shares = [np.abs(setpoints[:, :-1] - middle) / half, *limit_uses(setpoints, limits.motion, rate)]
    position, velocity, acceleration, jerk = (largest_use(share, setpoints[:, -1], limits.names) for share in shares)
    return position, velocity, acceleration, jerk


def _limit_sources(arm: Arm) -> str:
    """Say for a certificate which limits of a user's model the operator gave, and which nobody did; else nothing."""
    if arm.model is None:
        return ""
    said = {LimitSource.OPERATOR: "by the operator", LimitSource.DEFAULT: "by default"}
    parts = []
    for source, words in said.items():
        kinds = [
            kind for kind in LIMIT_KINDS if any(getattr(joint, kind).source is source for joint in arm.model.joints)
        ]
        parts += [f"; limits {words}: {', '.join(kinds)}"] if kinds else []
    return "".join(parts)
