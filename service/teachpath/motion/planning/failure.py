"""Where a path fails first, over which stretch, why, and what to change."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.collision_model import Clearance
from teachpath.motion.paths.ik_branches import Candidate, describe_fault, node_faults
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.planning.suggestion import fault_margin, margin_shortfall, suggest_move
from teachpath.motion.settings import MotionSettings
from teachpath.records import Failure, Scene, Suggestion, Vector

# An arm that comes to the end of its reach is singular first; what is told is why it cannot go on.
FAULT_PRIORITY: Final = ("reach", "limit", "turn", "singular")


def first_failing_range(failing: NDArray[np.bool_]) -> tuple[int, int]:
    """Return the first run of True as indices of its first and last element; raises ValueError when there is none."""
    first = int(np.argmax(failing))
    if not failing[first]:
        raise ValueError("nothing fails")
    behind = np.flatnonzero(~failing[first:])
    return first, first + int(behind[0]) - 1 if len(behind) else len(failing) - 1


def kinematic_failure(tool_path: ToolPath, candidate: Candidate, settings: MotionSettings) -> Failure | None:
    """Find where a branch of the arm fails first by reach, joint limits, a turn of the wrist or a singular pose."""
    named = node_faults(candidate, settings)
    if not np.any(named != ""):
        return None
    first, last = first_failing_range(named != "")
    here = set(named[first : last + 1])
    fault = next(word for word in FAULT_PRIORITY if word in here)
    same = [k for k in range(first, last + 1) if named[k] == fault]
    worst = max(same, key=lambda k: margin_shortfall(fault, candidate, k, settings))
    change = suggest_move(
        tool_path,
        candidate,
        worst,
        fault_margin(fault, candidate, worst),
        margin_shortfall(fault, candidate, worst, settings),
    )
    reason = describe_fault(candidate, tool_path, worst, fault, settings)
    return _failure(tool_path, fault, (first, last), reason, change)


def collision_failure(
    tool_path: ToolPath,
    candidate: Candidate,
    nodes: NDArray[np.int64],
    rows: Sequence[Clearance],
    required: float,
    distances: Callable[[Array], Array],
) -> Failure | None:
    """Find where arm or carried object come too near to something first.

    Args:
        way: the route.
        candidate: branch of the arm.
        nodes: (m,) of the route that were measured.
        rows: what was measured at each of them.
        least: distance that is asked for [m].
        distances: measures configurations (k, 6): (k,) [m].
    """
    near = np.array([row.distance for row in rows]) < required
    if not near.any():
        return None
    first, last = first_failing_range(near)
    worst = min(range(first, last + 1), key=lambda k: rows[k].distance)
    row, node = rows[worst], int(nodes[worst])
    change = suggest_move(tool_path, candidate, node, lambda q, outside: distances(q), required - row.distance)
    reason = f"{row.describe_violation(row.distance, required)}, {tool_path.describe_node(node)}"
    return _failure(tool_path, "collision", (int(nodes[first]), int(nodes[last])), reason, change)


def start_failure(tool_path: ToolPath, scene: Scene, settings: MotionSettings) -> Failure | None:
    """Find that a path does not start where the scene's object stands."""
    if scene.carried is None:
        return None
    off = np.array(scene.carried.position) - tool_path.positions[0]
    if np.linalg.norm(off) <= settings.grasp_tolerance:
        return None
    x, y, z = (float(v) for v in off)
    sentence = f"move control point 1 of {len(tool_path.curve.control_points)} there"
    reason = (
        f"the path starts {100 * np.linalg.norm(off):.1f} cm from where {scene.carried.name} stands, at most "
        f"{100 * settings.grasp_tolerance:.1f} cm"
    )
    return _failure(tool_path, "start", (0, 0), reason, Suggestion(0, (x, y, z), sentence))


def describe(failure: Failure) -> str:
    """Say why and what to change, in one sentence."""
    begin, end = failure.interval
    over = f" (it fails from s = {begin:.3f} to {end:.3f} m)" if end > begin else ""
    return f"{failure.reason}{over}; {failure.suggestion.sentence}"


def _failure(tool_path: ToolPath, fault: str, stretch: tuple[int, int], reason: str, suggestion: Suggestion) -> Failure:
    first, last = stretch
    x, y, z = (float(v) for v in tool_path.positions[first])
    position: Vector = (x, y, z)
    s0, s1 = float(tool_path.lengths[first]), float(tool_path.lengths[last])
    return Failure(fault, s0, (s0, s1), position, reason, suggestion)
