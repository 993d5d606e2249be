"""How near a path brings arm and carried object to the scene: proved for the certificate, explained when too near."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from teachpath.errors import PathRefused
from teachpath.motion.branches import Candidate
from teachpath.motion.failure import collision_failure, in_words
from teachpath.motion.joints import JointPath
from teachpath.motion.proof import FINEST, Proved, Sweep, least
from teachpath.motion.puma560 import Array
from teachpath.motion.route import Route
from teachpath.motion.scene import Clearance, CollisionModel, grasp_of
from teachpath.motion.settings import MotionSettings
from teachpath.records import Extreme


def path_clearance(
    way: Route, candidate: Candidate, model: CollisionModel, settings: MotionSettings, joints: JointPath | None = None
) -> Extreme:
    """Prove the least clearance along a path.

    Args:
        way: the route.
        candidate: the arm's branch on it.
        model: of the scene.
        settings: what is asked for.
        joints: what the arm will do; None to look at straight lines between the candidate's nodes instead.

    Raises:
        PathRefused: something comes too near; says where and which control point to move.
    """
    load = grasp_of(model.scene, candidate.joints[0])
    levers = model.levers(load)
    sweep = Sweep.through(candidate.joints, levers) if joints is None else Sweep.along(joints, levers)

    def measure(q: Array) -> list[Clearance]:
        return model.clearances(q, load=load)

    proved = least(sweep, measure, settings.clearance_min)
    if proved.distance < settings.clearance_min:
        _too_near(way, candidate, settings.clearance_min, measure)
    if load is not None and joints is not None:
        lowest = -settings.contact_tolerance
        if least(sweep, lambda q: model.supports(q, load), lowest).distance < lowest:
            _too_near(way, candidate, lowest, lambda q: model.supports(q, load))
    return _extreme(proved, way, sweep, joints)


def _extreme(proved: Proved, way: Route, sweep: Sweep, joints: JointPath | None) -> Extreme:
    if joints is None:
        share = (proved.place - sweep.places[0]) / (sweep.places[-1] - sweep.places[0])
        s = float(way.lengths[round(share * (len(way.lengths) - 1))])
    else:
        s = float(joints(proved.place)[6])
    near = proved.measured
    return Extreme(proved.distance, f"{near.part} to {near.other} at s = {s:.3f} m" if near.part else "far", s)


def _too_near(way: Route, candidate: Candidate, asked: float, measure: Callable[[Array], list[Clearance]]) -> None:
    rows = measure(candidate.joints)
    # What was proved may be less than what is measured at the nodes: then the least of them is the place to tell.
    asked = max(asked, min(row.distance for row in rows) + FINEST)
    failure = collision_failure(
        way, candidate, np.arange(len(rows)), rows, asked, lambda q: np.array([row.distance for row in measure(q)])
    )
    assert failure is not None
    raise PathRefused(in_words(failure))
