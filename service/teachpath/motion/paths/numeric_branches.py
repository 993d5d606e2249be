"""Branches of numeric inverse kinematics: the solutions at a path's start, each followed along the path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.errors import PathRefused
from teachpath.motion.arm.serial_ik import POSE_TOLERANCE, SEEDS, all_solutions, follow_poses, limits_of, solve_near
from teachpath.records import Array, SerialArm

STRIDE: Final = 5  # nodes from one that is solved from the one before to the next; those between begin in between
FOLLOWING_ITERATIONS: Final = 12  # iterations from a neighbour's solution


@dataclass(frozen=True, eq=False)
class TrackedSolution:
    """One solution at the start of a path, followed along it.

    Attributes:
        way: number of the poses that it follows.
        joints: (n, joints) configurations [rad].
        excess: (n,) how far they leave the tool from its pose [m or rad]; 0 where they meet it.
    """

    way: int
    joints: Array
    excess: Array


def track_solutions(ways: Sequence[Array], arm: SerialArm) -> list[TrackedSolution]:
    """Follow every solution at the first pose of each way; where there is none, what comes nearest to one.

    Args:
        ways: of the tool, each (n, 4, 4) to world from the tool.
        arm: whose tool it is.
    """
    starts = [_starts(way[0], arm) for way in ways]
    of = np.repeat(np.arange(len(ways)), [len(start) for start in starts])
    poses, count = np.stack(ways)[of], len(ways[0])  # (k, n, 4, 4)
    coarse = np.unique(np.append(np.arange(0, count, STRIDE), count - 1))
    rows = follow_poses(poses[:, coarse], np.concatenate(starts), arm, FOLLOWING_ITERATIONS)
    nodes = np.arange(count)
    seeds = [[np.interp(nodes, coarse, joint) for joint in found.T] for found in rows]  # (k, dof, n)
    flat = np.swapaxes(np.array(seeds), 1, 2).reshape(-1, rows.shape[2])
    joints, off = solve_near(poses.reshape(-1, 4, 4), flat, arm, FOLLOWING_ITERATIONS)
    excess = np.where(off <= POSE_TOLERANCE, 0.0, off).reshape(len(of), count)
    each = zip(of, joints.reshape(len(of), count, -1), excess, strict=True)
    return [TrackedSolution(int(way), found, missed) for way, found, missed in each]


def follow_near(poses: Array, seeds: Array, arm: SerialArm, *, held: int | None = None) -> Array:
    """Return the configurations (m, joints) at poses (m, 4, 4) that are nearest to seeds (m, joints).

    Joint `held` keeps its angle.

    Raises:
        PathRefused: one of them does not close.
    """
    joints, off = solve_near(poses, seeds, arm, FOLLOWING_ITERATIONS, held=held)
    if off.max() > POSE_TOLERANCE:
        raise PathRefused(
            f"between two nodes of the path, {arm.name} was led {1e3 * off.max():.3g} mm past it: the path is too near "
            "a singular configuration there; move it, or turn the tool"
        )
    return joints


def _starts(pose: Array, arm: SerialArm) -> Array:
    """Return all solutions (k, joints) that were found for a pose (4, 4), else the configuration nearest to one."""
    if len(solutions := all_solutions(pose, arm)):
        return solutions
    lower, upper = limits_of(arm)
    seeds = np.random.default_rng(0).uniform(lower, upper, (SEEDS, len(lower)))
    joints, off = solve_near(np.repeat(pose[None], SEEDS, axis=0), seeds, arm)
    return joints[[int(np.argmin(off))]]
