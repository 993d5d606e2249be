"""Finds the configurations before the start of a path and behind its goal: above it, nearer, or at its side."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from teachpath.errors import PathRefused
from teachpath.motion.arm.kinematics import inverse_kinematics, tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.serial_ik import POSE_TOLERANCE, solve_near
from teachpath.motion.collision.collision_model import CollisionModel, Load
from teachpath.motion.refusals import first_accepted
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.joint_moves import placed_load, prove_move_clear, waypoints_home

LIFT_SHARES: Final = (1.0, 0.5, 0.25)  # of `motion.lift`
# Components: away from the arm, to its left, up.
LIFT_DIRECTIONS: Final = np.array(
    [[0, 0, 1], [-1, 0, 1], [0, 1, 1], [0, -1, 1], [1, 0, 1], [-1, 0, 0], [0, 1, 0], [0, -1, 0]], dtype=np.float64
)


def approach_configurations(q: Array, arm: Arm, settings: MotionSettings) -> list[Array]:
    """Return configurations (joints,) from which the tool goes straight to configuration `q` (joints,), the best first.

    The tool keeps its orientation. It begins `motion.lift` away, or a share of it: above, slanted, or from a side. The
    last configuration is `q` itself. Those out of reach or beyond a joint limit are left out.
    """
    pose = tool_pose(q, arm)
    ahead = pose[:2, 3] / max(float(np.hypot(*pose[:2, 3])), 1e-9)
    axes = np.array([[ahead[0], ahead[1], 0.0], [-ahead[1], ahead[0], 0.0], [0.0, 0.0, 1.0]])
    directions = LIFT_DIRECTIONS / np.linalg.norm(LIFT_DIRECTIONS, axis=1)[:, None] @ axes
    poses = np.repeat(pose[None], len(directions) * len(LIFT_SHARES), axis=0)
    poses[:, :3, 3] += (np.array(LIFT_SHARES)[None, :, None] * settings.lift * directions[:, None]).reshape(-1, 3)
    found = _nearest_solutions(poses, q, arm)
    within = [each for each in found if np.all(each >= arm.limits.lower) and np.all(each <= arm.limits.upper)]
    return [*within, q.copy()]


def _nearest_solutions(poses: Array, q: Array, arm: Arm) -> list[Array]:
    """Return the configurations (joints,) nearest to `q` (joints,) at those of poses (m, 4, 4) that the arm reaches."""
    if arm.model is not None:
        joints, off = solve_near(poses, np.repeat(q[None], len(poses), axis=0), arm.model)
        return list(joints[off <= POSE_TOLERANCE])
    solutions = inverse_kinematics(poses, arm, previous_q4=float(q[3]))
    found = []
    for branches, excess in zip(solutions.joints, solutions.reach_excess[:, 0], strict=True):
        turned = branches + 2 * np.pi * np.round((q - branches) / (2 * np.pi))
        if excess <= 0:
            found.append(turned[int(np.argmin(np.abs(turned - q).max(axis=1)))])
    return found


def find_approach(model: CollisionModel, start: Array, settings: MotionSettings) -> Array:
    """Find the configuration (joints,) over which the arm goes from its home to the start of a path.

    Raises:
        PathRefused: none of those tried is free; the sentence says what is in the way of the first.
    """
    carried = model.scene.carried
    load, home = Load(position=carried.position) if carried else None, np.array(settings.home)

    # The home of the Puma 560 is above the table; where a user's model has its own, only the user knows.
    from_home = "" if model.arm.model is None else " from its home (say a free one as home of the settings)"
    to_start = f"on the way{from_home} to the path's start"

    def checked(stop: Array) -> Array:
        """Return a configuration over which the moves are free; raises PathRefused."""
        for a, b, what in ((home, stop, to_start), (stop, start, "above the start")):
            prove_move_clear(
                model, np.stack([a, b]), settings, load=load, gripper_open=carried is not None, move_name=what
            )
        return stop

    return _first_checked(approach_configurations(start, model.arm, settings), checked, "start")


def find_retreat(model: CollisionModel, start: Array, goal: Array, settings: MotionSettings) -> Array:
    """Find the configuration (joints,) over which the arm goes from the goal of a path to its home.

    Raises:
        PathRefused: none of those tried is free; the sentence says what is in the way of the first.
    """
    behind = placed_load(model, start, goal)

    def checked(stop: Array) -> Array:
        """Return a configuration over which the moves are free; raises PathRefused."""
        stops = np.stack([goal, stop])
        prove_move_clear(
            model, stops, settings, load=behind, gripper_open=behind is not None, move_name="above the goal"
        )
        waypoints_home(model, start, goal, stop, settings)
        return stop

    return _first_checked(approach_configurations(goal, model.arm, settings), checked, "goal")


def _first_checked(configurations: list[Array], checked: Callable[[Array], Array], end: str) -> Array:
    try:
        return first_accepted(configurations, checked)
    except PathRefused as refusal:
        raise PathRefused(
            f"{refusal}; none of {len(configurations)} ways to the {end} of the path is free, "
            f"from above, nearer or its side: move the {end}, or what stands around it"
        ) from None
