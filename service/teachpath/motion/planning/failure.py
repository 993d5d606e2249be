"""Explains where a path fails first, over which interval, why, and which control point to move."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from teachpath.errors import PathRefused
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.collision_model import Clearance, CollisionModel, Load, grasped_load
from teachpath.motion.collision.continuous import MIN_STEP
from teachpath.motion.paths.ik_branches import Candidate, describe_fault, nearest_to_usable, node_faults
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.planning.suggestion import fault_margin, margin_shortfall, suggest_move
from teachpath.motion.refusals import refusal
from teachpath.motion.settings import MotionSettings
from teachpath.records import Failure, PathFault, Suggestion, Vector

# An arm at the end of its reach is singular shortly before; the reason why it cannot go on is the one to tell.
FAULT_PRIORITY: Final[tuple[PathFault, ...]] = ("reach", "limit", "turn", "singular")


def first_failing_range(failing: NDArray[np.bool_]) -> tuple[int, int]:
    """Return the first run of True as indices of its first and last element; raises ValueError when there is none."""
    first = int(np.argmax(failing))
    if not failing[first]:
        raise ValueError("nothing fails")
    behind = np.flatnonzero(~failing[first:])
    return first, first + int(behind[0]) - 1 if len(behind) else len(failing) - 1


def no_candidate(
    tool_path: ToolPath, candidates: Sequence[Candidate], model: CollisionModel, settings: MotionSettings
) -> PathRefused:
    """Explain why no candidate can follow a path.

    Args:
        tool_path: what the tool is to follow.
        candidates: those that are usable, the best first; where none is, all.
        model: of arm and scene.
        settings: what may be used of the arm.
    """
    failure = kinematic_failure(tool_path, nearest_to_usable(candidates), settings)
    return refusal(failure or clearance_failure(tool_path, candidates[0], model, settings))


def kinematic_failure(tool_path: ToolPath, candidate: Candidate, settings: MotionSettings) -> Failure | None:
    """Find where a candidate fails first by reach, joint limits, a turn of the wrist or a singular pose."""
    named = node_faults(candidate, settings)
    if not np.any(named != ""):
        return None
    first, last = first_failing_range(named != "")
    here = set(named[first : last + 1])
    fault = next(word for word in FAULT_PRIORITY if word in here)
    same = [k for k in range(first, last + 1) if named[k] == fault]
    worst = max(same, key=lambda k: margin_shortfall(fault, candidate, k, settings))
    suggestion = suggest_move(
        tool_path,
        candidate,
        worst,
        fault_margin(fault, candidate, worst),
        margin_shortfall(fault, candidate, worst, settings),
    )
    reason = describe_fault(candidate, tool_path, worst, fault, settings)
    return _failure(tool_path, fault, (first, last), reason, suggestion)


def clearance_failure(
    tool_path: ToolPath, candidate: Candidate, model: CollisionModel, settings: MotionSettings
) -> Failure:
    """Find where arm or carried object come too near to something first, on a candidate on which they do."""
    load = grasped_load(model, candidate.joints[0])
    return _collision_failure(tool_path, candidate, settings.clearance_min, lambda q: model.clearances(q, load=load))


def support_failure(
    tool_path: ToolPath, candidate: Candidate, model: CollisionModel, load: Load, settings: MotionSettings
) -> Failure:
    """Find where a carried object dips into its support first, on a candidate on which it does."""
    deepest = -settings.contact_tolerance
    return _collision_failure(tool_path, candidate, deepest, lambda q: model.support_distances(q, load))


def _collision_failure(
    tool_path: ToolPath, candidate: Candidate, required: float, measure: Callable[[Array], list[Clearance]]
) -> Failure:
    """Find where a distance is too small first.

    Args:
        tool_path: what the tool is to follow.
        candidate: the branch and roll of the tool.
        required: distance to keep [m].
        measure: returns the distances at configurations (m, 6).
    """
    rows = measure(candidate.joints)
    distances = np.array([row.distance for row in rows])
    # A proof covers what lies between the nodes; where the nodes themselves keep the distance, the nearest is named.
    required = max(required, float(distances.min()) + MIN_STEP)
    first, last = first_failing_range(distances < required)
    worst = min(range(first, last + 1), key=lambda k: rows[k].distance)
    row = rows[worst]
    suggestion = suggest_move(
        tool_path,
        candidate,
        worst,
        lambda q, outside: np.array([row.distance for row in measure(q)]),
        required - row.distance,
    )
    reason = f"{row.describe_violation(row.distance, required)}, {tool_path.describe_node(worst)}"
    return _failure(tool_path, "collision", (first, last), reason, suggestion)


def _failure(
    tool_path: ToolPath, fault: PathFault, nodes: tuple[int, int], reason: str, suggestion: Suggestion
) -> Failure:
    first, last = nodes
    x, y, z = (float(v) for v in tool_path.positions[first])
    position: Vector = (x, y, z)
    s0, s1 = float(tool_path.lengths[first]), float(tool_path.lengths[last])
    return Failure(fault, s0, (s0, s1), position, reason, suggestion)
