"""A quick look at a curve that is being edited: sample by sample, whether the arm could follow it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.collision_model import Clearance, CollisionModel, grasped_load
from teachpath.motion.paths.ik_branches import Candidate, enumerate_candidates, nearest_to_usable, node_faults
from teachpath.motion.paths.tool_path import ToolPath, sample_tool_path
from teachpath.motion.planning.candidates import clear_candidates, usable_candidates
from teachpath.motion.planning.clearance import clearance_failure, support_failure
from teachpath.motion.planning.failure import describe, kinematic_failure, start_failure
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.timing import estimate_duration
from teachpath.nurbs import Curve
from teachpath.records import Assessment, Failure, Scene

ASSESSED_SAMPLES: Final = 100  # of the answer


@dataclass(frozen=True, eq=False)
class _Inspection:
    """What is looked at, and the candidate that a plan would take, with its clearance at every sample."""

    tool_path: ToolPath
    settings: MotionSettings
    nodes: NDArray[np.int64]
    candidate: Candidate
    clearances: list[Clearance]
    failure: Failure | None


def assess(
    curve: Curve,
    scene: Scene,
    settings: MotionSettings | None = None,
    *,
    arm: Arm | None = None,
    orientation: Curve | None = None,
) -> Assessment:
    """Look at a curve as quickly as an editor needs it; only `plan` certifies.

    Branch and roll of the tool are chosen as a plan does it, so what fails here fails there. The duration is estimated
    from limits of speed and acceleration; torques, and moves to the path and away from it, are not looked at.

    Args:
        curve: positions [m].
        scene: what stands around.
        settings: as for `plan`.
        arm: as for `plan`.
        turn: quaternions of what is carried, at the same parameter.

    Raises:
        PathRefused: there is nothing to sample: the curve is no longer than a point, or stands still.
    """
    settings = settings or MotionSettings()
    way = sample_tool_path(curve, settings, orientation=orientation if settings.orientation == "demonstrated" else None)
    arm = arm or Arm.of_variant(settings.variant)
    look = _inspect(way, CollisionModel(scene, arm), settings)
    nodes, candidate, failure = look.nodes, look.candidate, look.failure
    duration = (
        None if failure else estimate_duration(way, candidate, arm.limits.motion.scaled(*[settings.path_share] * 3))
    )
    return Assessment(
        lengths=way.lengths[nodes],
        parameters=way.parameters[nodes],
        positions=way.positions[nodes],
        faults=_faults(look),
        reach=-candidate.branch.reach_excess[nodes],
        limits=np.minimum(arm.limits.upper - candidate.joints, candidate.joints - arm.limits.lower).min(axis=1)[nodes],
        singular=candidate.singular_values[nodes],
        clearance=np.array([row.distance for row in look.clearances]),
        nearest=tuple(f"{row.body} to {row.other_body}" if row.body else "" for row in look.clearances),
        branch=candidate.description,
        duration=duration,
        failure=failure,
        sentence=describe(failure) if failure else _verdict(candidate, look.clearances, duration),
    )


def _inspect(tool_path: ToolPath, model: CollisionModel, settings: MotionSettings) -> _Inspection:
    """Choose a candidate as `plan` does, and find what fails first."""
    nodes = np.unique(np.linspace(0, len(tool_path.lengths) - 1, ASSESSED_SAMPLES + 1).round().astype(np.int64))
    every = enumerate_candidates(tool_path, model.arm, settings)
    fit = usable_candidates(every, settings)
    free = clear_candidates(tool_path, fit, model, settings)
    candidate = (free or fit or [nearest_to_usable(every)])[0]
    load = grasped_load(model, candidate.joints[0])
    rows = model.clearances(candidate.joints[nodes], load=load)
    failure = start_failure(tool_path, model.scene, settings) or kinematic_failure(tool_path, candidate, settings)
    if failure is None and not free:
        failure = clearance_failure(tool_path, candidate, model, settings)
    if failure is None and load is not None:
        lowest = min(row.distance for row in model.support_distances(candidate.joints[nodes], load))
        if lowest < -settings.contact_tolerance:
            failure = support_failure(tool_path, candidate, model, load, settings)
    return _Inspection(tool_path, settings, nodes, candidate, rows, failure)


def _faults(look: _Inspection) -> tuple[str, ...]:
    """Give every sample the first fault between it and the next one."""
    named, failure = node_faults(look.candidate, look.settings), look.failure
    if failure is not None and failure.fault == "collision":
        begin, end = failure.interval
        named[(look.tool_path.lengths >= begin) & (look.tool_path.lengths <= end)] = "collision"
    pieces = np.split(named, look.nodes[1:])
    words = [next((str(word) for word in piece if word), "") for piece in pieces]
    near = [row.distance < look.settings.clearance_min for row in look.clearances]
    words = [word or ("collision" if close else "") for word, close in zip(words, near, strict=True)]
    if failure is not None and failure.fault == "start":
        words[0] = "start"
    return tuple(words)


def _verdict(candidate: Candidate, rows: list[Clearance], duration: float | None) -> str:
    least = min(rows, key=lambda row: row.distance)
    gap = f", {1000 * least.distance:.0f} mm from {least.body} to {least.other_body}" if least.body else ""
    about = f"in about {duration:.1f} s ({candidate.description}{gap})"
    return f"the arm can probably follow it, {about}; plan it to be sure"
