"""A quick look at a curve that is being edited: sample by sample, whether the arm could follow it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from teachpath.motion.arm.joint_path import ARM
from teachpath.motion.arm.puma560 import LOWER, UPPER
from teachpath.motion.collision.collision_model import Clearance, CollisionModel, grasp_of
from teachpath.motion.paths.ik_branches import Candidate, candidates, faults, least_wrong
from teachpath.motion.paths.tool_path import Route, route
from teachpath.motion.planning.candidates import clear, fitting
from teachpath.motion.planning.clearance import dipping, nearing
from teachpath.motion.planning.failure import in_words, kinematic_failure, start_failure
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.timing import estimate
from teachpath.nurbs import Curve
from teachpath.records import Assessment, Failure, Scene

SAMPLES: Final = 100  # of the answer


@dataclass(frozen=True, eq=False)
class _Look:
    """What is looked at, and the candidate that a plan would take, with its clearance at every sample."""

    way: Route
    settings: MotionSettings
    nodes: NDArray[np.int64]
    candidate: Candidate
    rows: list[Clearance]
    failure: Failure | None


def assess(
    curve: Curve, scene: Scene, settings: MotionSettings | None = None, *, turn: Curve | None = None
) -> Assessment:
    """Look at a curve as quickly as an editor needs it; only `plan` certifies.

    Branch and roll of the tool are chosen as a plan does it, so what fails here fails there. The duration is estimated
    from limits of speed and acceleration; torques, and moves to the path and away from it, are not looked at.

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
    look = _look(way, scene, settings)
    nodes, candidate, failure = look.nodes, look.candidate, look.failure
    duration = None if failure else estimate(way, candidate, ARM.scaled(*[settings.path_share] * 3))
    return Assessment(
        lengths=way.lengths[nodes],
        parameters=way.parameters[nodes],
        positions=way.positions[nodes],
        faults=_faults(look),
        reach=-candidate.arm.outside[nodes],
        limits=np.minimum(UPPER - candidate.joints, candidate.joints - LOWER).min(axis=1)[nodes],
        singular=candidate.singular[nodes],
        clearance=np.array([row.distance for row in look.rows]),
        nearest=tuple(f"{row.part} to {row.other}" if row.part else "" for row in look.rows),
        branch=candidate.branch,
        duration=duration,
        failure=failure,
        sentence=in_words(failure) if failure else _verdict(candidate, look.rows, duration),
    )


def _look(way: Route, scene: Scene, settings: MotionSettings) -> _Look:
    """Choose a candidate as `plan` does, and find what fails first."""
    model = CollisionModel(scene)
    nodes = np.unique(np.linspace(0, len(way.lengths) - 1, SAMPLES + 1).round().astype(np.int64))
    every = candidates(way, settings)
    fit = fitting(every, settings)
    free = clear(way, fit, model, settings)
    candidate = (free or fit or [least_wrong(every)])[0]
    load = grasp_of(scene, candidate.joints[0])
    rows = model.clearances(candidate.joints[nodes], load=load)
    failure = start_failure(way, scene, settings) or kinematic_failure(way, candidate, settings)
    if failure is None and not free:
        failure = nearing(way, candidate, model, settings)
    if failure is None and load is not None:
        lowest = min(row.distance for row in model.supports(candidate.joints[nodes], load))
        if lowest < -settings.contact_tolerance:
            failure = dipping(way, candidate, model, load, settings)
    return _Look(way, settings, nodes, candidate, rows, failure)


def _faults(look: _Look) -> tuple[str, ...]:
    """Give every sample the first fault between it and the next one."""
    named, failure = faults(look.candidate, look.settings), look.failure
    if failure is not None and failure.fault == "collision":
        begin, end = failure.stretch
        named[(look.way.lengths >= begin) & (look.way.lengths <= end)] = "collision"
    pieces = np.split(named, look.nodes[1:])
    words = [next((str(word) for word in piece if word), "") for piece in pieces]
    near = [row.distance < look.settings.clearance_min for row in look.rows]
    words = [word or ("collision" if close else "") for word, close in zip(words, near, strict=True)]
    if failure is not None and failure.fault == "start":
        words[0] = "start"
    return tuple(words)


def _verdict(candidate: Candidate, rows: list[Clearance], duration: float | None) -> str:
    least = min(rows, key=lambda row: row.distance)
    gap = f", {1000 * least.distance:.0f} mm from {least.part} to {least.other}" if least.part else ""
    about = f"in about {duration:.1f} s ({candidate.branch}{gap})"
    return f"the arm can probably follow it, {about}; plan it to be sure"
