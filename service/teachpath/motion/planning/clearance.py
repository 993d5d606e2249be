"""Proves how near a path brings arm and carried object to the scene."""

from __future__ import annotations

from typing import Final

from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.collision.collision_model import CollisionModel, grasped_load
from teachpath.motion.collision.continuous import ContinuousCheck, ProvedDistance, prove_distance
from teachpath.motion.paths.ik_branches import Candidate
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.planning.failure import clearance_failure, support_failure
from teachpath.motion.refusals import refusal
from teachpath.motion.settings import MotionSettings
from teachpath.records import Extreme

SUFFICIENT_CLEARANCE: Final = 0.02  # m, more is not worth a costlier branch or more rolling of the tool
SMOOTHING_CLEARANCE: Final = 0.001  # m, that a search asks for on top, because smoothing changes the angles
CLEARANCE_WEIGHT: Final = 300.0  # cost of a missing metre of clearance in a search; a turn by one step costs 1


def rough_clearance(
    tool_path: ToolPath, candidate: Candidate, model: CollisionModel, settings: MotionSettings
) -> Extreme:
    """Return the least clearance on straight lines of the joints between a candidate's nodes.

    A clearance below the one that the settings ask for is a rough value: nothing more is proved then.
    """
    load = grasped_load(model, candidate.joints[0])
    check = ContinuousCheck.along_lines(candidate.joints, model.lever_arms(load))
    proved = prove_distance(check, lambda q: model.clearances(q, load=load), settings.clearance_min)
    share = (proved.parameter - check.parameters[0]) / (check.parameters[-1] - check.parameters[0])
    return _extreme(proved, float(tool_path.lengths[round(share * (len(tool_path.lengths) - 1))]))


def path_clearance(
    tool_path: ToolPath, candidate: Candidate, model: CollisionModel, settings: MotionSettings, joints: JointPath
) -> Extreme:
    """Prove the least clearance along a path, and that a carried object stays above its support.

    Args:
        tool_path: what the tool is to follow.
        candidate: the branch and roll of the tool.
        model: of arm and scene.
        settings: clearance to keep.
        joints: how the joints follow the path.

    Raises:
        PathRefused: something comes too near; the sentence says where, and which control point to move.
    """
    load = grasped_load(model, candidate.joints[0])
    check = ContinuousCheck.along_spline(joints, model.lever_arms(load))
    proved = prove_distance(check, lambda q: model.clearances(q, load=load), settings.clearance_min)
    if proved.distance < settings.clearance_min:
        raise refusal(clearance_failure(tool_path, candidate, model, settings))
    if load is not None:
        deepest = -settings.contact_tolerance
        if prove_distance(check, lambda q: model.support_distances(q, load), deepest).distance < deepest:
            raise refusal(support_failure(tool_path, candidate, model, load, settings))
    return _extreme(proved, float(joints(proved.parameter)[-1]))


def _extreme(proved: ProvedDistance, s: float) -> Extreme:
    near = proved.nearest
    return Extreme(proved.distance, f"{near.body} to {near.other_body} at s = {s:.3f} m" if near.body else "far", s)
