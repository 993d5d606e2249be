"""From a learned path to a plan that the arm can execute, with its certificate, or to the reason why not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.mounting import check_mounting
from teachpath.motion.collision.collision_model import CollisionModel, grasped_load
from teachpath.motion.collision.grasp import tool_offset_of
from teachpath.motion.paths.enumeration import enumerate_candidates
from teachpath.motion.paths.ik_branches import Candidate
from teachpath.motion.paths.posture import distance_from_shown, toward_shown
from teachpath.motion.paths.tool_path import ToolPath, sample_tool_path
from teachpath.motion.planning.approach import find_approach, find_retreat
from teachpath.motion.planning.candidates import clear_candidates, usable_candidates
from teachpath.motion.planning.certificate import certify
from teachpath.motion.planning.clearance import path_clearance
from teachpath.motion.planning.digest import with_digest
from teachpath.motion.planning.failure import no_candidate
from teachpath.motion.planning.model_arms import check_home, check_plannable, with_home
from teachpath.motion.planning.start_grasp import check_start, grasping_candidates
from teachpath.motion.planning.torque_limited import time_within_torques
from teachpath.motion.refusals import first_accepted
from teachpath.motion.settings import MotionSettings
from teachpath.records import LearnedPath, Plan, Scene, ShownPosture, ToolOutput


def plan(
    path: LearnedPath,
    scene: Scene,
    settings: MotionSettings | None = None,
    *,
    arm: Arm | None = None,
    plan_id: str = "plan",
    shown: ShownPosture | None = None,
    output: ToolOutput | None = None,
) -> Plan:
    """Plan the pick and place along a path: the centre of the carried object follows it.

    The arm goes from its home to above the start (or nearer, or beside it), down, closes the gripper, follows the path,
    opens the gripper, goes up and home. Without a carried object the tool centre point follows it, the gripper closed.
    A suction cup stays above the object, and goes with it.

    Args:
        path: what to follow.
        scene: what stands around the arm.
        settings: what may be used of the arm; the defaults when None.
        arm: that is to follow the path; the one that the settings describe when None.
        plan_id: of the plan that is made.
        shown: joints of this arm that are preferred, where one showed the path: of all ways to follow it the nearest to
            these is taken that can be certified.
        output: of the arm that is to be on while the tool follows the path; None: none.

    Returns:
        A plan with its certificate.

    Raises:
        PathRefused: the arm cannot follow it; the sentence says why, where, and which control point to move.
        UnusableSettings: the arm's home is outside the joint limits, or the gripper would stand in the wrist.
        UnusableInput: the arm is a user's model, which has no gripper, and the scene an object to carry; or the joints
            shown are of an arm with another number of joints.
    """
    settings = settings or MotionSettings()
    arm = arm or Arm.of_settings(settings)
    scene = replace(scene, display_name="")  # a signed one would bind the plan to it
    ways = (None,) if shown is None else (shown, None)
    made = first_accepted(ways, lambda preferred: _plan_near(preferred, path, scene, settings, arm))
    posture = None if shown is None else distance_from_shown(made.lengths, made.joints, shown, arm.limits.names)
    return with_digest(replace(made, id=plan_id, posture=posture, output=output), arm)


def _plan_near(shown: ShownPosture | None, path: LearnedPath, scene: Scene, settings: MotionSettings, arm: Arm) -> Plan:
    """Plan a path, near to the joints that were shown where there are any; its certificate has no digest yet."""
    check_plannable(arm, scene, shown)
    settings = with_home(settings, arm)
    check_home(settings, arm)
    check_mounting(arm)
    offset = tool_offset_of(scene, arm)
    tool_path = sample_tool_path(path.curve, settings, orientation=path.orientation, tool_offset=offset)
    tool_path = tool_path if shown is None else toward_shown(tool_path, shown)
    check_start(tool_path, scene, arm, settings)
    model = CollisionModel(scene, arm)
    candidates = grasping_candidates(tool_path, enumerate_candidates(tool_path, arm, settings), scene)
    usable = usable_candidates(candidates, settings, tool_path.posture)
    clear = clear_candidates(tool_path, usable, model, settings)
    if not clear:
        raise no_candidate(tool_path, usable or candidates, model, settings)
    return first_accepted(clear, lambda candidate: _certified_plan(path, tool_path, candidate, model, settings))


def _certified_plan(
    path: LearnedPath, tool_path: ToolPath, candidate: Candidate, model: CollisionModel, settings: MotionSettings
) -> Plan:
    """Time a candidate, find its approach and retreat, and certify it; raises PathRefused where one of them fails."""
    load = grasped_load(model, candidate.joints[0])
    dynamics = Dynamics(model.arm, model.scene.carried, load.grasp_pose if load else None)
    timed = time_within_torques(tool_path, candidate, dynamics, settings)
    clearance = path_clearance(tool_path, candidate, model, settings, timed.joints)
    start, goal = timed.joints.joints[0], timed.joints.joints[-1]
    above_start = find_approach(model, start, settings)
    above_goal = find_retreat(model, start, goal, settings)
    return Plan(
        id="",
        path=path.id,
        path_version=path.version,
        scene=model.scene,
        lengths=timed.joints.lengths,
        joints=timed.joints.joints,
        squared_rates=timed.squared_rates,
        limits=np.stack([timed.limits.speed, timed.limits.acceleration, timed.limits.jerk]),
        tool_speed=model.arm.tool_speed,
        above_start=above_start,
        above_goal=above_goal,
        duration=timed.trajectory.duration,
        certificate=certify(tool_path, candidate, timed, clearance, settings),
    )
