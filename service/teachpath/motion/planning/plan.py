"""From a learned path to a plan the arm can execute, with its certificate, or to the reason why not."""

from __future__ import annotations

import uuid
from dataclasses import dataclass, replace

import numpy as np

from teachpath.errors import PathRefused, UnusableSettings
from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.paths.ik_branches import Candidate, enumerate_candidates, nearest_to_usable
from teachpath.motion.paths.tool_path import ToolPath, sample_tool_path
from teachpath.motion.planning.approach import find_approach, find_retreat
from teachpath.motion.planning.candidates import clear_candidates, usable_candidates
from teachpath.motion.planning.certificate import digest, largest_limit_uses
from teachpath.motion.planning.clearance import clearance_refusal, path_clearance
from teachpath.motion.planning.failure import describe, kinematic_failure, start_failure
from teachpath.motion.planning.suggestion import name_control_point
from teachpath.motion.planning.torque_limited import time_within_torques
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.timed_trajectory import TimedTrajectory, time_joint_path
from teachpath.nurbs import Curve
from teachpath.records import Certificate, Extreme, Failure, LearnedPath, Plan, Scene


@dataclass(frozen=True, eq=False)
class _PlanningJob:
    """What stays the same while branches are tried."""

    path: LearnedPath
    scene: Scene
    settings: MotionSettings
    tool_path: ToolPath
    model: CollisionModel


def plan(path: LearnedPath, scene: Scene, settings: MotionSettings | None = None, *, arm: Arm | None = None) -> Plan:
    """Plan the pick and place along a path: the centre of the carried object follows it, the tool points down.

    The arm goes from its home to above the start (or nearer, or beside it), down, closes the gripper, follows the path,
    opens the gripper, goes up and home. Without a carried object it follows the path with the gripper closed.

    Args:
        path: what to follow.
        scene: what stands around.
        settings: what may be used of the arm; the defaults when None.
        arm: that is to follow it; the published variant that the settings name when None.

    Returns:
        A plan with its certificate.

    Raises:
        PathRefused: the arm cannot; the sentence says why, where, and which control point to move.
        UnusableSettings: the arm's home is outside the joint limits.
    """
    settings = settings or MotionSettings()
    arm = arm or Arm.of_variant(settings.variant)
    _home_within_limits(settings, arm)
    way = sample_tool_path(path.curve, settings, orientation=_turn(path, settings))
    _refuse(start_failure(way, scene, settings))
    every = enumerate_candidates(way, arm, settings)
    fit = usable_candidates(every, settings)
    if not fit:
        _refuse(kinematic_failure(way, nearest_to_usable(every), settings))
    job = _PlanningJob(path, scene, settings, way, CollisionModel(scene, arm))
    return _first_certified(job, fit)


def _first_certified(job: _PlanningJob, fit: list[Candidate]) -> Plan:
    """Certify the first of the candidates that keep clear with which everything else can be done too."""
    free = clear_candidates(job.tool_path, fit, job.model, job.settings)
    if not free:
        raise clearance_refusal(job.tool_path, fit[0], job.model, job.settings)
    refused: PathRefused | None = None
    for candidate in free:
        try:
            return _certified(job, candidate)
        except PathRefused as error:
            refused = refused or error
    assert refused is not None
    raise refused


def _home_within_limits(settings: MotionSettings, arm: Arm) -> None:
    lower, upper = arm.limits.lower, arm.limits.upper
    for joint, angle in enumerate(settings.home):
        if not lower[joint] <= angle <= upper[joint]:
            limits = f"{lower[joint]:.3f} to {upper[joint]:.3f}"
            raise UnusableSettings(f"motion.home puts joint {joint + 1} to {angle:.3f} rad, limits {limits}")


def _certified(job: _PlanningJob, candidate: Candidate) -> Plan:
    settings, way, arm = job.settings, job.tool_path, job.model.arm
    joints, pace, limits, torque = time_within_torques(way, candidate, Dynamics(arm, job.scene.carried), settings)
    _tool_on_path(way, joints, arm, settings)
    clearance = path_clearance(way, candidate, job.model, settings, joints)
    start, goal = joints.joints[0], joints.joints[-1]
    above_start = find_approach(job.model, start, settings)
    above_goal = find_retreat(job.model, start, goal, settings)
    track = time_joint_path(joints, pace, limits)
    drawn = Plan(
        id=f"plan-{uuid.uuid4().hex[:12]}",
        path=job.path.id,
        path_version=job.path.version,
        scene=job.scene,
        lengths=joints.lengths,
        joints=joints.joints,
        pace=pace,
        limits=np.stack([limits.speed, limits.acceleration, limits.jerk]),
        above_start=above_start,
        above_goal=above_goal,
        duration=track.duration,
        certificate=_certificate(way, candidate, track, settings, torque, clearance),
    )
    return replace(drawn, certificate=replace(drawn.certificate, digest=digest(drawn, arm)))


def _certificate(
    tool_path: ToolPath,
    candidate: Candidate,
    trajectory: TimedTrajectory,
    settings: MotionSettings,
    torque: Extreme,
    clearance: Extreme,
) -> Certificate:
    """Measure what the setpoints use of the limits; the digest is left out.

    Raises:
        PathRefused: it is more than what may be used.
    """
    position, velocity, acceleration, jerk = largest_limit_uses(
        trajectory.setpoints(settings.rate), settings.rate, candidate.branch.arm.limits
    )
    worst = max((velocity, acceleration, jerk), key=lambda extreme: extreme.value)
    if worst.value > settings.path_share:
        raise PathRefused(
            f"a limit is used to {100 * worst.value:.1f} % by {worst.place}, at most "
            f"{100 * settings.path_share:.1f} %; smooth the path there: move {name_control_point(tool_path, worst.s)}"
        )
    singular_s = float(tool_path.lengths[int(np.argmin(candidate.singular_values))])
    return Certificate(
        digest="",
        branch=candidate.description,
        position_use=position,
        velocity_use=velocity,
        acceleration_use=acceleration,
        jerk_use=jerk,
        torque_use=torque,
        least_singular=Extreme(candidate.min_singular_value, f"s = {singular_s:.3f} m", singular_s),
        clearance=clearance,
    )


def _tool_on_path(tool_path: ToolPath, joints: JointPath, arm: Arm, settings: MotionSettings) -> None:
    samples = joints.dense_parameters()
    reached = joints(samples)
    wanted = tool_path.curve(tool_path.arc.parameters(reached[:, 6]))
    off = np.linalg.norm(tool_pose(reached[:, :6], arm)[:, :3, 3] - wanted, axis=1)
    worst = int(np.argmax(off))
    if off[worst] > settings.path_tolerance:
        s = float(reached[worst, 6])
        raise PathRefused(
            f"the path bends too sharply to be followed within its tolerance "
            f"{tool_path.describe_node(int(np.argmin(np.abs(tool_path.lengths - s))))}; "
            f"move {name_control_point(tool_path, s)}"
        )


def _turn(path: LearnedPath, settings: MotionSettings) -> Curve | None:
    return path.orientation if settings.orientation == "demonstrated" else None


def _refuse(failure: Failure | None) -> None:
    if failure is not None:
        raise PathRefused(describe(failure), failure)
