"""A quick look at a curve that is being edited: sample by sample, whether the arm could follow it."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from teachpath.motion.branches import Candidate, candidates, cost, faults, least_wrong, usable
from teachpath.motion.failure import collision_failure, in_words, kinematic_failure, start_failure
from teachpath.motion.joints import ARM
from teachpath.motion.puma560 import LOWER, UPPER, Array
from teachpath.motion.route import Route, route
from teachpath.motion.scene import Clearance, CollisionModel, Load, grasp_of
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing import estimate
from teachpath.nurbs import Curve
from teachpath.records import Assessment, Failure, Scene

SAMPLES: Final = 100  # of the answer
TRIED: Final = 3  # branches and rolls whose clearance is measured at most
SPACIOUS: Final = 0.01  # m of clearance with which no other branch is looked for


def assess(
    curve: Curve,
    scene: Scene,
    settings: MotionSettings | None = None,
    *,
    turn: Curve | None = None,
) -> Assessment:
    """Look at a curve as quickly as an editor needs it; only `plan` certifies.

    Kinematics are exact at every node of the plan's own route, distances are measured at the samples alone, the
    duration is estimated from limits of speed and acceleration, and neither moves to the path and away from it are
    looked at nor rolls of the tool that change along it.

    Args:
        curve: positions [m].
        scene: what stands around.
        settings: as for `plan`.
        turn: quaternions of what is carried, at the same parameter.

    Raises:
        PathRefused: there is nothing to sample: the curve is no longer than a point, or stands still.
    """
    settings = settings or MotionSettings()
    way = route(curve, settings, turn=turn if settings.orientation == "demonstrated" else None)
    model = CollisionModel(scene)
    nodes = np.unique(np.linspace(0, len(way.lengths) - 1, SAMPLES + 1).round().astype(np.int64))
    candidate, rows = _best(way, model, nodes, settings)
    failure = (
        start_failure(way, scene, settings)
        or kinematic_failure(way, candidate, settings)
        or _collision(way, model, candidate, nodes, rows, settings)
    )
    named = faults(candidate, settings)
    near = np.array([row.distance for row in rows]) < settings.clearance_min
    duration = None if failure else estimate(way, candidate, ARM.scaled(*[settings.path_share] * 3))
    return Assessment(
        lengths=way.lengths[nodes],
        parameters=way.parameters[nodes],
        positions=way.positions[nodes],
        faults=_at_samples(named, nodes, near, failure),
        reach=-candidate.arm.outside[nodes],
        limits=np.minimum(UPPER - candidate.joints, candidate.joints - LOWER).min(axis=1)[nodes],
        singular=candidate.singular[nodes],
        clearance=np.array([row.distance for row in rows]),
        nearest=tuple(f"{row.part} to {row.other}" if row.part else "" for row in rows),
        branch=candidate.branch,
        duration=duration,
        failure=failure,
        sentence=in_words(failure) if failure else _verdict(candidate, rows, duration),
    )


def _best(
    way: Route, model: CollisionModel, nodes: NDArray[np.int64], settings: MotionSettings
) -> tuple[Candidate, list[Clearance]]:
    """Choose the branch and roll that a plan would most likely take, with its clearance at every sample."""
    every = candidates(way, settings)
    fit = sorted((c for c in every if usable(c, settings)), key=lambda c: cost(c, settings))
    if not fit:
        fit = [least_wrong(every)]
    best: tuple[float, Candidate, list[Clearance]] | None = None
    for candidate in fit[:TRIED]:
        rows = model.clearances(candidate.joints[nodes], load=_load(model, candidate))
        least = min(row.distance for row in rows)
        if best is None or least > best[0]:
            best = least, candidate, rows
        if least > SPACIOUS:
            break
    assert best is not None
    return best[1], best[2]


def _load(model: CollisionModel, candidate: Candidate) -> Load | None:
    return grasp_of(model.scene, candidate.joints[0])


def _collision(
    way: Route,
    model: CollisionModel,
    candidate: Candidate,
    nodes: NDArray[np.int64],
    rows: list[Clearance],
    settings: MotionSettings,
) -> Failure | None:
    load = _load(model, candidate)

    def distances(q: Array) -> Array:
        return np.array([row.distance for row in model.clearances(q, load=load)])

    return collision_failure(way, candidate, nodes, rows, settings.clearance_min, distances)


def _at_samples(
    named: NDArray[np.str_], nodes: NDArray[np.int64], near: NDArray[np.bool_], failure: Failure | None
) -> tuple[str, ...]:
    """Give every sample the first fault between it and the next one."""
    pieces = np.split(named, nodes[1:])
    words = [next((str(word) for word in piece if word), "") for piece in pieces]
    words = [word or ("collision" if close else "") for word, close in zip(words, near, strict=True)]
    if failure is not None and failure.fault == "start":
        words[0] = "start"
    return tuple(words)


def _verdict(candidate: Candidate, rows: list[Clearance], duration: float | None) -> str:
    least = min(rows, key=lambda row: row.distance)
    gap = f", {1000 * least.distance:.0f} mm from {least.part} to {least.other}" if least.part else ""
    about = f"in about {duration:.1f} s ({candidate.branch}{gap})"
    return f"the arm can probably follow it, {about}; plan it to be sure"
