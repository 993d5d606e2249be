"""Certifies a plan: measures how much of each limit its setpoints use, and signs it with a digest."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict

import numpy as np

from teachpath.errors import PathRefused
from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.limits import JointLimits, MotionLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import TOOL_LENGTH, Array
from teachpath.motion.paths.ik_branches import Candidate
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.planning.torque_limited import TimedPath
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.limit_margins import largest_use, limit_uses
from teachpath.motion.timing.timed_trajectory import TimedTrajectory, time_joint_path
from teachpath.records import Certificate, Extreme, Plan, Scene


def digest(plan: Plan, arm: Arm) -> str:
    """Compute the SHA-256 (hex) over all that decides the motion: arm, path, scene, configurations, limits, timing."""
    total = hashlib.sha256()
    total.update(repr(arm.links).encode())
    if arm.tool_length != TOOL_LENGTH:  # with the tool of the table, plans keep the digests that they were stored with
        total.update(repr(arm.tool_length).encode())
    total.update(f"{plan.path}|{plan.path_version}|".encode())
    total.update(_scene_text(plan.scene).encode())
    numbers = (plan.lengths, plan.joints, plan.pace, plan.limits, plan.above_start, plan.above_goal, plan.duration)
    limits = arm.limits
    rows = (limits.lower, limits.upper, limits.speed, limits.acceleration, limits.jerk, limits.torque)
    for value in (*numbers, *rows):
        array = np.ascontiguousarray(value, dtype="<f8")
        total.update(f"{array.shape}".encode())
        total.update(array.tobytes())
    return total.hexdigest()


def verify(plan: Plan, arm: Arm) -> None:
    """Check that a plan is the one that was certified, for this arm.

    Raises:
        PathRefused: the digest does not match: path, scene, limits or timing have changed since, or the arm is another.
    """
    if digest(plan, arm) != plan.certificate.digest:
        raise PathRefused(
            f"plan {plan.id} has changed since it was certified, or is for another arm than the {arm.name} "
            "(motion.variant); plan the path again"
        )


def plan_trajectory(plan: Plan) -> TimedTrajectory:
    """Return the motion of a plan along its path at full speed; it is the same wherever it is computed."""
    path = JointPath(np.linspace(0.0, 1.0, len(plan.lengths)), plan.lengths, plan.joints)
    return time_joint_path(path, plan.pace, MotionLimits(*plan.limits))


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
    singular_s = float(tool_path.lengths[int(np.argmin(candidate.singular_values))])
    return Certificate(
        digest="",
        branch=candidate.description,
        position_use=position,
        velocity_use=velocity,
        acceleration_use=acceleration,
        jerk_use=jerk,
        torque_use=timed.torque_use,
        least_singular=Extreme(candidate.min_singular_value, f"s = {singular_s:.3f} m", singular_s),
        clearance=clearance,
    )


def largest_limit_uses(setpoints: Array, rate: float, limits: JointLimits) -> tuple[Extreme, Extreme, Extreme, Extreme]:
    """Measure how much of the joints' position, speed, acceleration and jerk limits setpoints use.

    Args:
        setpoints: (n, 7) joints [rad] and where on the path each lies [m].
        rate: setpoints a second [Hz].
        limits: of the joints.
    """
    middle, half = (limits.lower + limits.upper) / 2, (limits.upper - limits.lower) / 2
    shares = [np.abs(setpoints[:, :6] - middle) / half, *limit_uses(setpoints, limits.motion, rate)]
    position, velocity, acceleration, jerk = (largest_use(share, setpoints[:, 6]) for share in shares)
    return position, velocity, acceleration, jerk


def _scene_text(scene: Scene) -> str:
    def plain(value: object) -> object:
        if isinstance(value, dict):
            return {key: plain(inner) for key, inner in value.items()}
        if isinstance(value, list | tuple):
            return [plain(inner) for inner in value]
        return float(value) if isinstance(value, int | float) else value

    return json.dumps(plain(asdict(scene)), sort_keys=True)
