"""The least distance on a whole motion, proved between the places where it was measured.

While joints turn, no point of the arm moves farther than their turns times their longest levers. So a distance that is
a at one end of a piece of motion and b at the other cannot fall below (a + b - w) / 2 between them, when w bounds the
way of every point on the piece. Pieces are halved until that is near enough to what was measured.
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

INITIAL_STEP: Final = 0.04  # m, way of a piece to begin with
MIN_STEP: Final = 0.0001  # m, way of a piece that is not halved any more
ABSOLUTE_TOLERANCE: Final = 0.0005  # m, between what is proved and what was measured; or a share of it
RELATIVE_TOLERANCE: Final = 0.1
MAX_BISECTIONS: Final = 14

Measure = Callable[[Array], list[Clearance]]


@dataclass(frozen=True, eq=False)
class ContinuousCheck:
    """A motion of the joints by one parameter.

    Attributes:
        places: (k,) increasing parameters.
        ways: (k,) bound on the way [m] of any point of the arm up to each of them; it grows evenly in between.
        at: returns configurations (m, 6) at parameters (m,).
    """

    parameters: Array
    motion_bounds: Array
    configurations: Callable[[Array], Array]

    @staticmethod
    def along_spline(path: JointPath, lever_arms: Array) -> ContinuousCheck:
        """Sweep a spline; a B-spline's derivative lies within its coefficients.

        Args:
            path: the joints.
            levers: (6,) longest lever of each joint [m] (see `CollisionModel.levers`).
        """
        slope = path.spline.derivative()
        knots = np.unique(slope.t)
        last = np.searchsorted(slope.t, knots[:-1], side="right") - 1  # newest coefficient of each span
        active = np.abs(slope.c[last[:, None] - np.arange(slope.k + 1), :6]).max(axis=1)
        ways = np.concatenate([[0.0], np.cumsum(np.diff(knots) * (active @ lever_arms))])
        return ContinuousCheck(knots, ways, lambda places: path(places)[:, :6])

    @staticmethod
    def along_lines(waypoints: Array, lever_arms: Array) -> ContinuousCheck:
        """Sweep straight lines of the joints between configurations (k, 6)."""
        ways = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(waypoints, axis=0)) @ lever_arms)])
        index = np.arange(len(waypoints), dtype=np.float64)
        return ContinuousCheck(
            index, ways, lambda at: np.stack([np.interp(at, index, joint) for joint in waypoints.T], axis=1)
        )


@dataclass(frozen=True, eq=False)
class ProvedDistance:
    """A distance [m] that is kept on a whole motion, and the place and pair at which the least was measured."""

    distance: float
    parameter: float
    nearest: Clearance


def prove_distance(check: ContinuousCheck, measure: Measure, required: float) -> ProvedDistance:
    """Prove a least distance on a motion.

    Args:
        sweep: the motion.
        measure: the distances at configurations (m, 6).
        asked: distance [m] that should be kept; when less was measured, nothing more is proved, and when less is
            proved than was measured, pieces are halved as long as it helps.
    """
    count = max(1, int(np.ceil(check.motion_bounds[-1] / INITIAL_STEP)))
    ways = np.linspace(0.0, check.motion_bounds[-1], count + 1)
    rows = measure(check.configurations(_parameters_at(check, ways)))
    for _ in range(MAX_BISECTIONS):
        distances, steps = np.array([row.distance for row in rows]), np.diff(ways)
        between = (distances[1:] + distances[:-1] - steps) / 2
        lowest = float(distances.min())
        if lowest < required:
            break
        wanted = max(lowest - max(ABSOLUTE_TOLERANCE, RELATIVE_TOLERANCE * lowest), required)
        coarse = np.flatnonzero((between < wanted) & (steps > MIN_STEP))
        if not len(coarse):
            break
        middles = (ways[coarse] + ways[coarse + 1]) / 2
        rows = _merged(rows, coarse, measure(check.configurations(_parameters_at(check, middles))))
        ways = np.insert(ways, coarse + 1, middles)
    distances = np.array([row.distance for row in rows])
    between = (distances[1:] + distances[:-1] - np.diff(ways)) / 2
    worst = int(np.argmin(distances))
    place = float(_parameters_at(check, ways[worst : worst + 1])[0])
    return ProvedDistance(float(min(between.min(), distances[worst])), place, rows[worst])


def _parameters_at(check: ContinuousCheck, bounds: Array) -> Array:
    # Where nothing moves the ways do not grow; any place there will do.
    return np.interp(bounds, check.motion_bounds, check.parameters)


def _merged(rows: list[Clearance], behind: NDArray[np.int64], new: list[Clearance]) -> list[Clearance]:
    merged = list(rows)
    for index, row in sorted(zip(behind, new, strict=True), key=lambda pair: -pair[0]):
        merged.insert(int(index) + 1, row)
    return merged
