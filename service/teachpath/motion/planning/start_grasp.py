"""Finds the candidates whose fingers take the scene's object at the start of a path."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.collision_model import shape_pose
from teachpath.motion.collision.grasp import PLANNED_MARGIN, grasp_fault
from teachpath.motion.paths.ik_branches import Candidate
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.records import Scene, Shape


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
    flange = tool_path.poses(tool_path.parameters[:1])[0] @ turned
    return grasp_fault(carried, np.linalg.inv(flange) @ shape_pose(carried), arm, margin=PLANNED_MARGIN)
