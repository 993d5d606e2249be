"""Finds the candidates whose fingers take the scene's object at the start of a path."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.collision_model import shape_pose
from teachpath.motion.collision.grasp import PLANNED_MARGIN, grasp_fault
from teachpath.motion.paths.ik_branches import Candidate
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.refusals import describe_direction, refusal
from teachpath.motion.settings import MotionSettings
from teachpath.records import Failure, Scene, Shape, Suggestion

CENTRE_TOLERANCE: Final = 0.002  # m, between the start of a path and an object's middle: there is nothing to move


def check_start(tool_path: ToolPath, scene: Scene, arm: Arm, settings: MotionSettings) -> None:
    """Check that the fingers take the scene's object where a path starts.

    Raises:
        PathRefused: they do not.
    """
    failure = start_failure(tool_path, scene, arm, settings)
    if failure is not None:
        raise refusal(failure)


def grasping_candidates(tool_path: ToolPath, candidates: Sequence[Candidate], scene: Scene) -> list[Candidate]:
    """Return those whose fingers take the scene's object where the path starts; all where there is none."""
    carried = scene.carried
    if carried is None:
        return list(candidates)
    return [c for c in candidates if not start_grasp_fault(tool_path, carried, c.roll.angle, c.branch.arm)]


def start_grasp_fault(tool_path: ToolPath, carried: Shape, roll: float, arm: Arm) -> str:
    """Return why the fingers do not take the object where a path starts, in words; empty when they do.

    Args:
        tool_path: whose start it is.
        carried: the object.
        roll: of the tool [rad].
        arm: whose fingers they are.
    """
    turned, cosine, sine = np.eye(4), np.cos(roll), np.sin(roll)
    turned[:2, :2] = [[cosine, sine], [-sine, cosine]]  # joint 6 turns by the opposite angle (`ik_branches.roll_tool`)
    turned[2, 3] = -arm.tool_length
    gripper = tool_path.poses(tool_path.parameters[:1])[0] @ turned
    return grasp_fault(carried, np.linalg.inv(gripper) @ shape_pose(carried), arm, margin=PLANNED_MARGIN)


def start_failure(tool_path: ToolPath, scene: Scene, arm: Arm, settings: MotionSettings) -> Failure | None:
    """Return the failure of a path at whose start the fingers do not take the object, however the tool is rolled."""
    carried = scene.carried
    if carried is None:
        return None
    faults = [start_grasp_fault(tool_path, carried, roll, arm) for roll in settings.rolls]
    if not all(faults):
        return None
    x, y, z = (float(v) for v in np.array(carried.position) - tool_path.positions[0])
    off = float(np.linalg.norm((x, y, z)))
    reason = f"the path starts {100 * off:.1f} cm from where {carried.name} stands, and there {faults[0]}"
    sentence = f"put an object there that the gripper can take, or turn {carried.name}"
    if off > CENTRE_TOLERANCE:
        count = len(tool_path.curve.control_points)
        sentence = f"move control point 1 of {count} by {1000 * off:.0f} mm {describe_direction((x, y, z))}"
    begin_x, begin_y, begin_z = (float(v) for v in tool_path.positions[0])
    return Failure("start", 0.0, (0.0, 0.0), (begin_x, begin_y, begin_z), reason, Suggestion(0, (x, y, z), sentence))
