"""The redundancy of an arm with seven joints: one joint's angle, chosen at every place of a path.

With the tool at its pose and this joint at an angle, an arm of six joints is left, which has finitely many solutions.
Places of the path and angles form a grid for each of them, a *sheet*; dynamic programming goes through it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from teachpath.motion.arm.kinematics import min_singular_value
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.newton_grid import fill_row
from teachpath.motion.arm.serial_ik import POSE_TOLERANCE, RESIDUAL, geometry, limits_of, nearest_turn, solve_near
from teachpath.motion.arm.serial_kinematics import serial_jacobian
from teachpath.motion.paths.grid_search import cheapest_sequence, smoothed
from teachpath.motion.paths.numeric_branches import FOLLOWING_ITERATIONS, TrackedSolution
from teachpath.motion.paths.posture import posture_cost
from teachpath.motion.settings import MotionSettings
from teachpath.records import Array, SerialArm

ANGLE_STEP: Final = 0.25  # rad, between two angles of the joint, about
SEARCH_NODES: Final = 40  # of the path, about
SEEDS: Final = 100  # of the solutions at the path's start
SAMPLES: Final = 200  # configurations by which the joint is chosen
MAX_STEPS: Final = 2  # of angle from a search node to the next; a change by c costs c^2
UNREACHABLE_COST: Final = 1e4  # cost of a place where the arm cannot be, where a sequence may be there all the same
LIMIT_SHARE: Final = 0.99  # of half a joint's range, within which a sequence stays: smoothing changes it
SAME_SOLUTION_TOLERANCE: Final = 0.01  # rad, within which two solutions with the same angle are one


@dataclass(frozen=True, eq=False)
class Sheet:
    """Configurations at places of a path and angles of the redundant joint, continuous in both.

    Attributes:
        way: number of the poses that they follow.
        joint: number of the redundant joint, from 0.
        nodes: (m,) of the path.
        angles: (k,) of the joint [rad].
        joints: (m, k, joints) configurations [rad].
        off: (m, k) how far they leave the tool from its pose [m or rad].
    """

    way: int
    joint: int
    nodes: NDArray[np.int64]
    angles: Array
    joints: Array
    off: Array

    def costs(self, arm: Arm, settings: MotionSettings, posture: Array | None = None) -> Array:
        """Return the cost (m, k) of each configuration (see `ik_branches.cost`); infinite where the arm cannot be.

        Args:
            arm: whose configurations they are.
            settings: where the arm waits, and how near to a singular pose it may come.
            posture: (n, joints) at all nodes of the path that are preferred; None: any.
        """
        limits = arm.limits
        middle, half = (limits.lower + limits.upper) / 2, (limits.upper - limits.lower) / 2
        use = (np.abs(self.joints - middle) / half).max(axis=2)
        free = (self.off <= POSE_TOLERANCE) & (use <= LIMIT_SHARE)
        costs = np.full(self.off.shape, np.inf)
        values = min_singular_value(self.joints[free], arm)
        costs[free] = np.where(values >= settings.least_singular, 0.1 / np.maximum(values, 1e-9) + use[free], np.inf)
        travel = np.abs(self.joints[0] - np.array(settings.home)) / limits.speed
        costs[0] += 0.2 * travel.max(axis=1)
        return costs + posture_cost(self.joints, None if posture is None else posture[self.nodes][:, None])

    def cheapest(self, costs: Array, stride: int = 1) -> NDArray[np.int64] | None:
        """Return the angles' numbers (m,) of the cheapest sequence through costs (m, k) of rows; None without one."""
        return cheapest_sequence(costs, stride * MAX_STEPS)

    def smoothed(self, sequence: NDArray[np.int64], parameters: Array) -> BSpline[np.float64]:
        """Return the joint's angle as a function of the curve's parameter, for a sequence (m,) of angles' numbers.

        Args:
            sequence: of numbers in `angles`.
            parameters: (n,) of the curve at all nodes of the path.
        """
        return smoothed(parameters[self.nodes], self.angles[sequence])

    def tracked(self, sequence: NDArray[np.int64], angles: Array, poses: Array, arm: SerialArm) -> TrackedSolution:
        """Return the configurations at all nodes of the path: poses (n, 4, 4), and angles (n,) of the joint [rad]."""
        coarse = self.joints[np.arange(len(self.nodes)), sequence]
        seeds = np.stack([np.interp(np.arange(len(poses)), self.nodes, joint) for joint in coarse.T], axis=1)
        seeds[:, self.joint] = angles
        joints, off = solve_near(poses, seeds, arm, FOLLOWING_ITERATIONS, held=self.joint)
        return TrackedSolution(self.way, joints, np.where(off <= POSE_TOLERANCE, 0.0, off))


@dataclass(frozen=True, eq=False)
class Redundancy:
    """How the joint moves that an arm with seven joints has left.

    Attributes:
        sheet: through which it goes.
        angle: of the joint [rad] as a function of the curve's parameter.
    """

    sheet: Sheet
    angle: BSpline[np.float64]


@cache
def redundant_joint(arm: SerialArm) -> int:
    """Return the number of the joint that moves most surely while the tool keeps its pose."""
    lower, upper = limits_of(arm)
    q = np.random.default_rng(0).uniform(lower, upper, (SAMPLES, len(lower)))
    standing = np.abs(np.linalg.svd(serial_jacobian(q, arm))[2][:, -1])  # of unit length; the tool does not move
    return int(np.argmax(np.quantile(standing, 0.1, axis=0)))


def find_sheets(ways: Sequence[Array], arm: SerialArm) -> list[Sheet]:
    """Return the sheets of every way of the tool, each (n, 4, 4) to world from the tool, that begin within limits."""
    grid, count = _Grid(arm), len(ways[0])
    nodes = np.unique(np.linspace(0, count - 1, SEARCH_NODES).round().astype(np.int64))
    found = []
    for way, poses in enumerate(ways):
        for first, off in grid.first_rows(poses[0]):
            rows = [(first, off)]
            for pose in poses[nodes[1:]]:
                rows.append(grid.row(pose, rows[-1][0]))
            joints, distances = (np.stack(column) for column in zip(*rows, strict=True))
            found.append(Sheet(way, grid.joint, nodes, grid.angles, joints, distances))
    return found


class _Grid:
    """Solves for a row of a grid at a time: one pose, all angles of the redundant joint."""

    def __init__(self, arm: SerialArm) -> None:
        self._arm, self._geometry, self._limits = arm, geometry(arm), limits_of(arm)
        self.joint: int = redundant_joint(arm)
        lower, upper = (float(limit[self.joint]) for limit in self._limits)
        half = min((upper - lower) / 2, np.pi)
        count = int(np.ceil(2 * half / ANGLE_STEP)) + 1
        self.angles: Array = (lower + upper) / 2 + np.linspace(-half, half, count)

    def row(self, pose: Array, before: Array, begin: int = -1) -> tuple[Array, Array]:
        """Return configurations (k, joints) and their distances (k,) from a pose (4, 4) (see `fill_row`)."""
        joints, off = before.copy(), np.empty(len(self.angles))
        given = (*self._geometry, FOLLOWING_ITERATIONS, RESIDUAL, POSE_TOLERANCE)
        fill_row(np.ascontiguousarray(pose), self.angles, self.joint, before, begin, *given, joints, off)
        return joints, off

    def first_rows(self, pose: Array) -> list[tuple[Array, Array]]:
        """Return the row of every sheet at a pose (4, 4), where one of its configurations is within the limits."""
        columns, solutions = self._solutions(pose)
        rows: list[tuple[Array, Array]] = []
        for column, begin in zip(columns, solutions, strict=True):
            if not any(off[column] <= POSE_TOLERANCE and _same(joints[column], begin) for joints, off in rows):
                rows.append(self.row(pose, np.tile(begin, (len(self.angles), 1)), int(column)))
        return rows

    def _solutions(self, pose: Array) -> tuple[NDArray[np.int64], Array]:
        """Return solutions (n, joints) within the limits at a pose (4, 4), and the number (n,) of each one's angle."""
        (lower, upper), arm = self._limits, self._arm
        begin, end = np.maximum(lower, -np.pi), np.minimum(upper, np.pi)
        seeds = np.random.default_rng(0).uniform(begin, end, (SEEDS, len(lower)))
        columns = np.arange(SEEDS) % len(self.angles)
        seeds[:, self.joint] = self.angles[columns]
        q, off = solve_near(np.repeat(pose[None], SEEDS, axis=0), seeds, arm, held=self.joint)
        turned = nearest_turn(q, (lower + upper) / 2)
        turned[:, self.joint] = q[:, self.joint]
        good = (off <= POSE_TOLERANCE) & np.all((turned >= lower) & (turned <= upper), axis=1)
        return columns[good], turned[good]


def _same(one: Array, other: Array) -> bool:
    return float(np.abs(one - other).max()) <= SAME_SOLUTION_TOLERANCE
