"""Continuous collision checking: proves a least distance on a whole motion from distances at some configurations.

While joints turn, no point of the arm moves farther than the sum of their turns times their lever arms. So where w
bounds how far any point moves on an interval of the motion, and the distances at its ends are a and b, no distance on
the interval is below (a + b - w) / 2. Intervals are bisected until this bound is near enough to what was measured.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.collision_model import Clearance

INITIAL_STEP: Final = 0.04  # m, motion bound of the first intervals
MIN_STEP: Final = 0.0001  # m, motion bound below which an interval is not bisected
ABSOLUTE_TOLERANCE: Final = 0.0005  # m, between proved and measured distance; the larger of both tolerances counts
RELATIVE_TOLERANCE: Final = 0.1  # of the measured distance
MAX_BISECTIONS: Final = 14  # of one interval

Measure = Callable[[Array], list[Clearance]]


@dataclass(frozen=True, eq=False)
class ContinuousCheck:
    """A motion of the joints as a function of one parameter, with a bound on how far any point of the arm moves.

    Attributes:
        parameters: (k,) increasing.
        motion_bounds: (k,) upper bound of the path length [m] of any point up to each parameter; linear in between.
        configurations: returns configurations (m, joints) at parameters (m,).
    """

    parameters: Array
    motion_bounds: Array
    configurations: Callable[[Array], Array]

    @staticmethod
    def along_spline(path: JointPath, lever_arms: Array) -> ContinuousCheck:
        """Check a spline of the joints; the derivative of a B-spline lies within its coefficients.

        Args:
            path: of the joints.
            lever_arms: (joints,) of the joints [m] (see `CollisionModel.lever_arms`).
        """
        slope = path.spline.derivative()
        knots = np.unique(slope.t)
        last = np.searchsorted(slope.t, knots[:-1], side="right") - 1  # last coefficient of each span
        active = np.abs(slope.c[last[:, None] - np.arange(slope.k + 1), :-1]).max(axis=1)
        bounds = np.concatenate([[0.0], np.cumsum(np.diff(knots) * (active @ lever_arms))])
        return ContinuousCheck(knots, bounds, lambda parameters: path(parameters)[:, :-1])

    @staticmethod
    def along_lines(waypoints: Array, lever_arms: Array) -> ContinuousCheck:
        """Check straight lines of the joints between configurations `waypoints` (k, joints)."""
        bounds = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(waypoints, axis=0)) @ lever_arms)])
        index = np.arange(len(waypoints), dtype=np.float64)
        return ContinuousCheck(
            index, bounds, lambda at: np.stack([np.interp(at, index, joint) for joint in waypoints.T], axis=1)
        )


@dataclass(frozen=True, eq=False)
class ProvedDistance:
    """A distance [m] that is kept on a whole motion, with the parameter and the pair of the least measured one."""

    distance: float
    parameter: float
    nearest: Clearance


def prove_distance(check: ContinuousCheck, measure: Measure, required: float) -> ProvedDistance:
    """Prove a least distance on a motion.

    Args:
        check: the motion.
        measure: returns the distances at configurations (m, joints).
        required: distance [m] that should be kept. As soon as a smaller one is measured, nothing more is proved.
    """
    count = max(1, int(np.ceil(check.motion_bounds[-1] / INITIAL_STEP)))
    bounds = np.linspace(0.0, check.motion_bounds[-1], count + 1)
    rows = measure(check.configurations(_parameters_at(check, bounds)))
    for _ in range(MAX_BISECTIONS):
        distances, steps = np.array([row.distance for row in rows]), np.diff(bounds)
        between = (distances[1:] + distances[:-1] - steps) / 2
        lowest = float(distances.min())
        if lowest < required:
            break
        wanted = max(lowest - max(ABSOLUTE_TOLERANCE, RELATIVE_TOLERANCE * lowest), required)
        wide = np.flatnonzero((between < wanted) & (steps > MIN_STEP))
        if not len(wide):
            break
        middles = (bounds[wide] + bounds[wide + 1]) / 2
        rows = _merged(rows, wide, measure(check.configurations(_parameters_at(check, middles))))
        bounds = np.insert(bounds, wide + 1, middles)
    distances = np.array([row.distance for row in rows])
    between = (distances[1:] + distances[:-1] - np.diff(bounds)) / 2
    worst = int(np.argmin(distances))
    parameter = float(_parameters_at(check, bounds[worst : worst + 1])[0])
    return ProvedDistance(float(min(between.min(), distances[worst])), parameter, rows[worst])


def _parameters_at(check: ContinuousCheck, bounds: Array) -> Array:
    # Where nothing moves, the bound does not grow, and any parameter of that interval will do.
    return np.interp(bounds, check.motion_bounds, check.parameters)


def _merged(rows: list[Clearance], behind: NDArray[np.int64], new: list[Clearance]) -> list[Clearance]:
    merged = list(rows)
    for index, row in sorted(zip(behind, new, strict=True), key=lambda pair: -pair[0]):
        merged.insert(int(index) + 1, row)
    return merged
