"""How near a path brings arm and carried object to the scene: proved for the certificate, explained when too near."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from teachpath.errors import PathRefused
from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.collision_model import Clearance, CollisionModel, Load, grasp_of
from teachpath.motion.collision.continuous import FINEST, Proved, Sweep, least
from teachpath.motion.paths.ik_branches import Candidate
from teachpath.motion.paths.tool_path import Route
from teachpath.motion.planning.failure import collision_failure, in_words
from teachpath.motion.settings import MotionSettings
from teachpath.records import Extreme, Failure


def rough_clearance(way: Route, candidate: Candidate, model: CollisionModel, settings: MotionSettings) -> Extreme:
    """Find the clearance along straight lines between a candidate's nodes; when it is too small, not yet why."""
    load = grasp_of(model.scene, candidate.joints[0])
    sweep = Sweep.through(candidate.joints, model.levers(load))
    proved = least(sweep, lambda q: model.clearances(q, load=load), settings.clearance_min)
    share = (proved.place - sweep.places[0]) / (sweep.places[-1] - sweep.places[0])
    return _extreme(proved, float(way.lengths[round(share * (len(way.lengths) - 1))]))


def path_clearance(
    way: Route, candidate: Candidate, model: CollisionModel, settings: MotionSettings, joints: JointPath
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
    load = grasp_of(model.scene, candidate.joints[0])
    sweep = Sweep.along(joints, model.levers(load))
    proved = least(sweep, lambda q: model.clearances(q, load=load), settings.clearance_min)
    if proved.distance < settings.clearance_min:
        raise too_near(way, candidate, model, settings)
    if load is not None:
        lowest = -settings.contact_tolerance
        if least(sweep, lambda q: model.supports(q, load), lowest).distance < lowest:
            raise PathRefused(in_words(dipping(way, candidate, model, load, settings)))
    return _extreme(proved, float(joints(proved.place)[6]))


def too_near(way: Route, candidate: Candidate, model: CollisionModel, settings: MotionSettings) -> PathRefused:
    """Explain where something comes too near on a candidate, and which control point to move."""
    return PathRefused(in_words(nearing(way, candidate, model, settings)))


def nearing(way: Route, candidate: Candidate, model: CollisionModel, settings: MotionSettings) -> Failure:
    """Find where something comes too near first, on a candidate that does not keep clear."""
    load = grasp_of(model.scene, candidate.joints[0])
    return _found(way, candidate, settings.clearance_min, lambda q: model.clearances(q, load=load))


def dipping(way: Route, candidate: Candidate, model: CollisionModel, load: Load, settings: MotionSettings) -> Failure:
    """Find where a carried object dips into what it stands on at its start, on a candidate on which it does."""
    return _found(way, candidate, -settings.contact_tolerance, lambda q: model.supports(q, load))


def _extreme(proved: Proved, s: float) -> Extreme:
    near = proved.measured
    return Extreme(proved.distance, f"{near.part} to {near.other} at s = {s:.3f} m" if near.part else "far", s)


def _found(way: Route, candidate: Candidate, asked: float, measure: Callable[[Array], list[Clearance]]) -> Failure:
    rows = measure(candidate.joints)
    # What was proved may be less than what is measured at the nodes: then the least of them is the place to tell.
    asked = max(asked, min(row.distance for row in rows) + FINEST)
    failure = collision_failure(
        way, candidate, np.arange(len(rows)), rows, asked, lambda q: np.array([row.distance for row in measure(q)])
    )
    assert failure is not None
    return failure
