"""Inverse kinematics of any arm by Newton's method from many seeds; every solution is closed by forward kinematics.

This is the last resort where no closed form is known: it finds what its seeds lead to, and cannot say that there is
nothing else.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from teachpath.motion.arm.newton import approach_poses
from teachpath.motion.arm.poses import pose_matrix
from teachpath.motion.arm.serial_kinematics import link_terms, serial_link_frames
from teachpath.records import Array, SerialArm

POSE_TOLERANCE: Final = 1e-9  # m and rad, within which a solution meets its pose
RESIDUAL: Final = 1e-12  # m and rad, to which it is refined; rounding leaves some 1e-15
SEEDS: Final = 200  # of one pose
ITERATIONS: Final = 60  # from a random seed
SAME_SOLUTION_TOLERANCE: Final = 1e-4  # rad, within which two solutions are one


def solve_near(
    poses: Array, seeds: Array, arm: SerialArm, iterations: int = ITERATIONS, *, held: int | None = None
) -> tuple[Array, Array]:
    """Bring the tool to poses from seeds, by damped steps of Newton's method.

    Args:
        poses: (n, 4, 4) to world from the tool.
        seeds: (n, joints) configurations to begin at [rad].
        arm: whose tool it is.
        iterations: at most.
        held: number of a joint that keeps its angle; None: none does.

    Returns:
        (n, joints) configurations, and (n,) how far each leaves the tool from its pose: the larger of [m] and [rad].
    """
    q = approach_poses(poses, seeds, *geometry(arm), iterations, RESIDUAL, -1 if held is None else held)
    error = pose_errors(poses, q, arm)
    return q, np.maximum(np.linalg.norm(error[:, :3], axis=1), np.linalg.norm(error[:, 3:], axis=1))


def follow_poses(poses: Array, first: Array, arm: SerialArm, iterations: int = ITERATIONS) -> Array:
    """Lead the tool from pose to pose, each time from where it came before; whether it meets them is not checked.

    Args:
        poses: (n, m, 4, 4) to world from the tool, m one after another.
        first: (n, joints) configurations at the first ones [rad].
        arm: whose tool it is.
        iterations: at most, for each pose.

    Returns:
        (n, m, joints) configurations.
    """
    given, rows = geometry(arm), [first]
    for number in range(1, poses.shape[1]):
        at = np.ascontiguousarray(poses[:, number])
        rows.append(approach_poses(at, rows[-1], *given, iterations, RESIDUAL, -1))
    return np.stack(rows, axis=1)


def pose_errors(poses: Array, q: Array, arm: SerialArm) -> Array:
    """Return what turns and moves the tool from configurations (n, joints) to poses (n, 4, 4): (n, 6) [m], [rad]."""
    tool = serial_link_frames(q, arm)[:, -1] @ pose_matrix(arm.tool)
    turn = Rotation.from_matrix(poses[:, :3, :3] @ np.swapaxes(tool[:, :3, :3], 1, 2)).as_rotvec()
    return np.concatenate([poses[:, :3, 3] - tool[:, :3, 3], turn], axis=1)


def all_solutions(pose: Array, arm: SerialArm, seeds: int = SEEDS) -> Array:
    """Return the configurations (k, joints) within the joints' limits that were found for a pose (4, 4).

    Each meets the pose within `POSE_TOLERANCE`. An arm with seven joints has infinitely many: one is returned for each
    seed that leads to one. The same seeds are tried each time. Whole turns of a joint are no solutions of their own:
    each angle is the one nearest to the middle of the joint's range.
    """
    lower, upper = limits_of(arm)
    begin = np.random.default_rng(0).uniform(np.maximum(lower, -np.pi), np.minimum(upper, np.pi), (seeds, len(lower)))
    q, off = solve_near(np.repeat(pose[None], seeds, axis=0), begin, arm)
    q = nearest_turn(q[off <= POSE_TOLERANCE], (lower + upper) / 2)
    q = q[np.all((q >= lower) & (q <= upper), axis=1)]
    return _distinct(q)


def nearest_turn(q: Array, to: Array) -> Array:
    """Shift joints (..., joints) by whole turns to be nearest to configurations `to`."""
    return np.asarray(q + 2 * np.pi * np.round((to - q) / (2 * np.pi)))


def limits_of(arm: SerialArm) -> tuple[Array, Array]:
    """Return the least and largest angles (joints,) of the joints."""
    return (
        np.array([joint.lower.value for joint in arm.joints]),
        np.array([joint.upper.value for joint in arm.joints]),
    )


def geometry(arm: SerialArm) -> tuple[Array, Array, Array, Array]:
    """Return turns, axes, anchors and tool of an arm, as `approach_poses` takes them."""
    turns = np.array([link_terms(link) for link in arm.links])
    turns[0] = pose_matrix(arm.base) @ turns[0]
    axes, anchors = (np.array([getattr(joint, name) for joint in arm.joints]) for name in ("axis", "anchor"))
    return turns, axes, anchors, pose_matrix(arm.tool).copy()


def _distinct(q: Array) -> Array:
    """Return configurations (k, joints) without those that differ from an earlier one by whole turns alone."""
    kept: list[NDArray[np.float64]] = []
    for row in q:
        if all(np.abs(np.sin((row - other) / 2)).max() > SAME_SOLUTION_TOLERANCE / 2 for other in kept):
            kept.append(row)
    return np.array(kept).reshape(len(kept), q.shape[1])
