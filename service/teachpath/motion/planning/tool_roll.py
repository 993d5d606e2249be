"""Searches for a roll of the tool that changes along the path, where no constant roll keeps clear of everything.

Nodes of the path and roll angles form a grid; dynamic programming finds the sequence of angles that keeps clear and
turns least, and a spline smooths it. A tool on the axis of joint 6 is rolled by this joint alone, any other by the
whole arm.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from teachpath.motion.arm.kinematics import inverse_kinematics, min_singular_value
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.collision_model import CollisionModel, grasped_load
from teachpath.motion.paths.grid_search import cheapest_sequence, smoothed
from teachpath.motion.paths.ik_branches import Candidate, ToolRoll, is_usable, rolled_candidate, rolled_poses
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.planning.clearance import CLEARANCE_WEIGHT, SMOOTHING_CLEARANCE, SUFFICIENT_CLEARANCE
from teachpath.motion.settings import MotionSettings

ROLL_COUNT: Final = 24  # roll angles in a full turn
ROLL_STEP: Final = 2 * np.pi / ROLL_COUNT  # rad, between two roll angles
SEARCH_NODES: Final = 60  # of the path, about
COARSE_STRIDE: Final = 3  # of the first, coarse search, in search nodes
MAX_ROLL_STEPS: Final = 2  # that the tool may turn from a search node to the next


def rolling_candidates(
    tool_path: ToolPath, usable: list[Candidate], model: CollisionModel, settings: MotionSettings
) -> list[Candidate]:
    """Return candidates whose tool rolls along the path: one for each branch; with an object, one for each first roll.

    Args:
        tool_path: what the tool is to follow.
        usable: candidates with constant rolls, which fulfil everything that does not depend on the roll.
        model: of arm and scene.
        settings: clearance to keep.
    """
    found, carries = [], model.scene.carried is not None
    first = {
        (candidate.branch.index, str(candidate.roll) if carries else ""): candidate for candidate in reversed(usable)
    }
    for candidate in first.values():
        if angles := _search_rolls(tool_path, candidate, model, settings):
            roll = ToolRoll(spline=smoothed(*angles))
            found.append(rolled_candidate(tool_path, candidate.branch, roll))
    return [candidate for candidate in found if is_usable(candidate, settings)]


def _search_rolls(
    tool_path: ToolPath, candidate: Candidate, model: CollisionModel, settings: MotionSettings
) -> tuple[Array, Array] | None:
    """Return parameters (k,) of the curve and roll angles (k,) [rad] there; None where no sequence keeps clear.

    The object is grasped with the candidate's own roll.
    """
    nodes = np.unique(np.linspace(0, len(tool_path.lengths) - 1, SEARCH_NODES).round().astype(np.int64))
    steps = _roll_steps(candidate.joints[nodes], model.arm)
    coarse = _roll_costs(tool_path, candidate, nodes[::COARSE_STRIDE], steps, model, settings)
    # A sequence through all nodes is one through some of them too; mostly these suffice to see that there is none.
    if cheapest_sequence(coarse, COARSE_STRIDE * MAX_ROLL_STEPS) is None:
        return None
    costs = np.empty((len(nodes), len(steps)))
    rest = np.arange(len(nodes)) % COARSE_STRIDE != 0
    costs[~rest], costs[rest] = (
        coarse,
        _roll_costs(tool_path, candidate, nodes[rest], steps, model, settings),
    )
    sequence = cheapest_sequence(costs, MAX_ROLL_STEPS)
    if sequence is None:
        return None
    u = tool_path.parameters[nodes]
    return u, candidate.roll(u) + ROLL_STEP * steps[sequence]


def _roll_steps(joints: Array, arm: Arm) -> NDArray[np.int64]:
    """Return the roll steps (m,) by which the tool can be rolled further at any of the configurations (k, 6)."""
    if not arm.rolls_by_joint_6:
        return np.arange(-ROLL_COUNT, ROLL_COUNT + 1)
    first = int(np.floor((joints[:, 5].min() - arm.limits.upper[5]) / ROLL_STEP))
    last = int(np.ceil((joints[:, 5].max() - arm.limits.lower[5]) / ROLL_STEP))
    return np.arange(first, last + 1)


def _roll_costs(
    tool_path: ToolPath, candidate: Candidate, nodes: NDArray[np.int64], steps: NDArray[np.int64],
    model: CollisionModel, settings: MotionSettings,
) -> Array:  # fmt: skip
    """Return the costs (k, m) of roll steps (m,) at nodes (k,); infinite where the tool cannot be rolled so."""
    arm = model.arm
    rolled, reached = _rolled_joints(tool_path, candidate, nodes, steps)
    clear = _clearances(tool_path, candidate, nodes, model)[:, steps % ROLL_COUNT]
    free = reached & np.all((rolled >= arm.limits.lower) & (rolled <= arm.limits.upper), axis=2)
    free &= clear >= settings.clearance_min + SMOOTHING_CLEARANCE
    if not arm.rolls_by_joint_6:  # which would not change the singular values
        free &= min_singular_value(rolled, arm) >= settings.least_singular
    costs = np.where(free, CLEARANCE_WEIGHT * np.maximum(SUFFICIENT_CLEARANCE - clear, 0.0), np.inf)
    if model.scene.carried is not None:
        costs[np.ix_(nodes == 0, steps != 0)] = np.inf  # the object is grasped with the candidate's own roll
    return costs


def _rolled_joints(
    tool_path: ToolPath, candidate: Candidate, nodes: NDArray[np.int64], steps: NDArray[np.int64]
) -> tuple[Array, NDArray[np.bool_]]:
    """Return configurations (k, m, 6) at nodes (k,) after roll steps (m,), and whether the arm reaches each (k, m)."""
    arm, branch = candidate.branch.arm, candidate.branch.index
    joints = np.repeat(candidate.joints[nodes][:, None], len(steps), axis=1)
    if arm.rolls_by_joint_6:
        joints[..., 5] -= ROLL_STEP * steps
        return joints, np.ones(joints.shape[:2], dtype=np.bool_)
    u = tool_path.parameters[nodes]
    poses = np.repeat(tool_path.poses(u)[:, None], len(steps), axis=1)
    rolls = candidate.roll(u)[:, None] + ROLL_STEP * steps
    solutions = inverse_kinematics(rolled_poses(poses, rolls, arm).reshape(-1, 4, 4), arm)
    solved = solutions.joints[:, branch].reshape(joints.shape)
    # From the candidate's own roll on, to both sides, without a leap by a whole turn.
    own = int(np.flatnonzero(steps == 0)[0])
    for side in (np.arange(own + 1, len(steps)), np.arange(own - 1, -1, -1)):
        joints[:, side] = np.unwrap(np.concatenate([joints[:, own : own + 1], solved[:, side]], axis=1), axis=1)[:, 1:]
    return joints, solutions.reach_excess[:, branch].reshape(joints.shape[:2]) <= 0


def _clearances(tool_path: ToolPath, candidate: Candidate, nodes: NDArray[np.int64], model: CollisionModel) -> Array:
    """Measure the clearances (k, ROLL_COUNT) [m] at nodes (k,) with the tool rolled by every roll step."""
    every, _ = _rolled_joints(tool_path, candidate, nodes, np.arange(ROLL_COUNT))
    rows = model.clearances(every.reshape(-1, 6), load=grasped_load(model, candidate.joints[0]))
    return np.array([row.distance for row in rows]).reshape(len(nodes), ROLL_COUNT)
