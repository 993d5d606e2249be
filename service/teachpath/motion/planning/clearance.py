"""How near a path brings arm and carried object to the scene: proved for the certificate, explained when too near."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from teachpath.errors import PathRefused
from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.collision_model import Clearance, CollisionModel, Load, grasped_load
from teachpath.motion.collision.continuous import MIN_STEP, ContinuousCheck, ProvedDistance, prove_distance
from teachpath.motion.paths.ik_branches import Candidate
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.planning.failure import collision_failure, describe
from teachpath.motion.settings import MotionSettings
from teachpath.records import Extreme, Failure


def rough_clearance(
    tool_path: ToolPath, candidate: Candidate, model: CollisionModel, settings: MotionSettings
) -> Extreme:
    """Find the clearance along straight lines between a candidate's nodes; when it is too small, not yet why."""
    load = grasped_load(model, candidate.joints[0])
    sweep = ContinuousCheck.along_lines(candidate.joints, model.lever_arms(load))
    proved = prove_distance(sweep, lambda q: model.clearances(q, load=load), settings.clearance_min)
    share = (proved.parameter - sweep.parameters[0]) / (sweep.parameters[-1] - sweep.parameters[0])
    return _extreme(proved, float(tool_path.lengths[round(share * (len(tool_path.lengths) - 1))]))


def path_clearance(
    tool_path: ToolPath, candidate: Candidate, model: CollisionModel, settings: MotionSettings, joints: JointPath
) -> Extreme:
    """Prove the least clearance along a path, and that a carried object stays above what it stands on.

    Args:
        way: the route.
        candidate: the arm's branch on it.
        model: of the scene.
        settings: what is asked for.
        joints: what the arm will do.

    Raises:
        PathRefused: something comes too near; says where and which control point to move.
    """
    load = grasped_load(model, candidate.joints[0])
    sweep = ContinuousCheck.along_spline(joints, model.lever_arms(load))
    proved = prove_distance(sweep, lambda q: model.clearances(q, load=load), settings.clearance_min)
    if proved.distance < settings.clearance_min:
        raise clearance_refusal(tool_path, candidate, model, settings)
    if load is not None:
        lowest = -settings.contact_tolerance
        if prove_distance(sweep, lambda q: model.support_distances(q, load), lowest).distance < lowest:
            failure = support_failure(tool_path, candidate, model, load, settings)
            raise PathRefused(describe(failure), failure)
    return _extreme(proved, float(joints(proved.parameter)[6]))


def clearance_refusal(
    tool_path: ToolPath, candidate: Candidate, model: CollisionModel, settings: MotionSettings
) -> PathRefused:
    """Explain where something comes too near on a candidate, and which control point to move."""
    failure = clearance_failure(tool_path, candidate, model, settings)
    return PathRefused(describe(failure), failure)


def clearance_failure(
    tool_path: ToolPath, candidate: Candidate, model: CollisionModel, settings: MotionSettings
) -> Failure:
    """Find where something comes too near first, on a candidate that does not keep clear."""
    load = grasped_load(model, candidate.joints[0])
    return _failure(tool_path, candidate, settings.clearance_min, lambda q: model.clearances(q, load=load))


def support_failure(
    tool_path: ToolPath, candidate: Candidate, model: CollisionModel, load: Load, settings: MotionSettings
) -> Failure:
    """Find where a carried object dips into what it stands on at its start, on a candidate on which it does."""
    return _failure(tool_path, candidate, -settings.contact_tolerance, lambda q: model.support_distances(q, load))


def _extreme(proved: ProvedDistance, s: float) -> Extreme:
    near = proved.nearest
    return Extreme(proved.distance, f"{near.body} to {near.other_body} at s = {s:.3f} m" if near.body else "far", s)


def _failure(
    tool_path: ToolPath, candidate: Candidate, required: float, measure: Callable[[Array], list[Clearance]]
) -> Failure:
    rows = measure(candidate.joints)
    # What was proved may be less than what is measured at the nodes: then the least of them is the place to tell.
    required = max(required, min(row.distance for row in rows) + MIN_STEP)
    failure = collision_failure(
        tool_path,
        candidate,
        np.arange(len(rows)),
        rows,
        required,
        lambda q: np.array([row.distance for row in measure(q)]),
    )
    assert failure is not None
    return failure
