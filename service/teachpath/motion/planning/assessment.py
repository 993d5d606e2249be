"""Assesses a curve that is being edited, quickly: sample by sample, whether the arm could follow it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, cast

import numpy as np
from numpy.typing import NDArray

from teachpath.lengths import describe_length
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.collision_model import Clearance, CollisionModel, grasped_load
from teachpath.motion.collision.grasp import tool_offset_of
from teachpath.motion.paths.enumeration import enumerate_candidates
from teachpath.motion.paths.ik_branches import Candidate, nearest_to_usable, node_faults
from teachpath.motion.paths.tool_path import ToolPath, sample_tool_path
from teachpath.motion.planning.candidates import clear_candidates, usable_candidates
from teachpath.motion.planning.failure import (
    clearance_failure,
    kinematic_failure,
    support_failure,
)
from teachpath.motion.planning.model_arms import check_plannable, with_home
from teachpath.motion.planning.start_grasp import grasping_candidates, start_failure
from teachpath.motion.refusals import describe
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.timing import estimate_duration
from teachpath.nurbs import Curve
from teachpath.records import Assessment, Failure, PathFault, Scene

ASSESSED_SAMPLES: Final = 100  # intervals between the samples of an assessment


@dataclass(frozen=True, eq=False)
class _Inspection:
    """The candidate that a plan would choose, with its clearances (m,) at the nodes (m,) of the samples."""

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
    """Assess a curve as quickly as an editor needs it; only `plan` certifies.

    Branch and roll of the tool are chosen as `plan` chooses them, so a curve that fails here fails there. The duration
    is estimated from the limits of speed and acceleration. Torques, approach and retreat are not checked.

    Args:
        curve: positions [m, world].
        scene: what stands around the arm.
        settings: as for `plan`.
        arm: as for `plan`.
        orientation: quaternions of what is carried, at the same parameter.

    Raises:
        PathRefused: there is nothing to sample: the curve is no longer than a point, or stands still.
        UnusableInput: the arm is a user's model without a gripper, and the scene has an object to carry.
    """
    settings = settings or MotionSettings()
    arm = arm or Arm.of_settings(settings)
    check_plannable(arm, scene)
    settings = with_home(settings, arm)
    offset = tool_offset_of(scene, arm)
    tool_path = sample_tool_path(curve, settings, orientation=orientation, tool_offset=offset)
    inspection = _inspect(tool_path, CollisionModel(scene, arm), settings)
    nodes, candidate, failure = inspection.nodes, inspection.candidate, inspection.failure
    limits = arm.limits.motion.scaled(*[settings.path_share] * 3)
    duration = None if failure else estimate_duration(tool_path, candidate, limits)
    gaps = np.minimum(arm.limits.upper - candidate.joints, candidate.joints - arm.limits.lower).min(axis=1)
    clearances = inspection.clearances
    return Assessment(
        lengths=tool_path.lengths[nodes],
        parameters=tool_path.parameters[nodes],
        positions=tool_path.positions[nodes],
        faults=_sample_faults(inspection),
        reach=-candidate.branch.reach_excess[nodes],
        limits=gaps[nodes],
        singular=candidate.singular_values[nodes],
        clearance=np.array([clearance.distance for clearance in clearances]),
        nearest=tuple(f"{c.body} to {c.other_body}" if c.body else "" for c in clearances),
        branch=candidate.description,
        duration=duration,
        failure=failure,
        sentence=describe(failure) if failure else _describe_success(candidate, clearances, duration),
    )


def _inspect(tool_path: ToolPath, model: CollisionModel, settings: MotionSettings) -> _Inspection:
    """Choose a candidate as `plan` does, and find what fails first."""
    nodes = np.unique(np.linspace(0, len(tool_path.lengths) - 1, ASSESSED_SAMPLES + 1).round().astype(np.int64))
    every = enumerate_candidates(tool_path, model.arm, settings)
    candidates = grasping_candidates(tool_path, every, model.scene) or every
    usable = usable_candidates(candidates, settings)
    clear = clear_candidates(tool_path, usable, model, settings)
    candidate = (clear or usable or [nearest_to_usable(candidates)])[0]
    load = grasped_load(model, candidate.joints[0])
    clearances = model.clearances(candidate.joints[nodes], load=load)
    failure = start_failure(tool_path, model.scene, model.arm, settings)
    failure = failure or kinematic_failure(tool_path, candidate, settings)
    if failure is None and not clear:
        failure = clearance_failure(tool_path, candidate, model, settings)
    if failure is None and load is not None:
        lowest = min(row.distance for row in model.support_distances(candidate.joints[nodes], load))
        if lowest < -settings.contact_tolerance:
            failure = support_failure(tool_path, candidate, model, load, settings)
    return _Inspection(tool_path, settings, nodes, candidate, clearances, failure)


def _sample_faults(inspection: _Inspection) -> tuple[PathFault | Literal[""], ...]:
    """Return for every sample the first fault between it and the next one; empty where there is none."""
    node_words, failure = node_faults(inspection.candidate, inspection.settings), inspection.failure
    if failure is not None and failure.fault == "collision":
        begin, end = failure.interval
        lengths = inspection.tool_path.lengths
        node_words[(lengths >= begin) & (lengths <= end)] = "collision"
    groups = np.split(node_words, inspection.nodes[1:])
    words = [next((str(word) for word in group if word), "") for group in groups]
    near = [clearance.distance < inspection.settings.clearance_min for clearance in inspection.clearances]
    words = [word or ("collision" if close else "") for word, close in zip(words, near, strict=True)]
    if failure is not None and failure.fault == "start":
        words[0] = "start"
    return tuple(cast(list[PathFault | Literal[""]], words))  # numpy has them as texts


def _describe_success(candidate: Candidate, clearances: list[Clearance], duration: float | None) -> str:
    least = min(clearances, key=lambda clearance: clearance.distance)
    gap = f", {describe_length(least.distance)} from {least.body} to {least.other_body}" if least.body else ""
    about = f"in about {duration:.1f} s ({candidate.description}{gap})"
    return f"the arm can probably follow it, {about}; plan it to be sure"
