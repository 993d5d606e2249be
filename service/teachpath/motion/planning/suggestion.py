"""Suggests which control point of a failing path to move, where to and how far, by trial moves of the tool."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.motion.arm.kinematics import inverse_kinematics, min_singular_value
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.serial_ik import POSE_TOLERANCE, solve_near
from teachpath.motion.paths.ik_branches import Candidate, roll_tool, rolled_poses
from teachpath.motion.paths.tool_path import ToolPath, control_point_weights
from teachpath.motion.refusals import describe_direction
from teachpath.motion.settings import MotionSettings
from teachpath.records import Suggestion

PROBE_DISTANCE: Final = 0.004  # m, of the moves that measure the slope of a margin
MIN_SLOPE: Final = 1e-9  # of a margin; a smaller one gives no direction
TRIED_DISTANCES: Final = (0.005, 0.01, 0.015, 0.02, 0.03, 0.04, 0.06, 0.08, 0.12, 0.16, 0.24)  # m
# For positive and negative x, y and z of the world, as seen from the robot.

# Returns margins (m,) of configurations (m, 6) whose wrist centres lie (m,) [m] out of reach; larger is better.
FaultMargin = Callable[[Array, Array], Array]


def fault_margin(fault: str, candidate: Candidate, node: int) -> FaultMargin:
    """Return the margin that must grow for a fault at a node (see `ik_branches.node_faults`) to disappear."""
    arm = candidate.branch.arm
    if fault == "reach":
        return lambda q, outside: -outside
    if fault == "limit":
        joint = int(np.argmax(candidate.limit_excess[node]))
        limits = arm.limits
        return lambda q, outside: np.minimum(limits.upper - q, q - limits.lower)[:, joint]
    if fault == "turn" and arm.model is None:
        return lambda q, outside: np.abs(np.sin(q[:, 4]))
    return lambda q, outside: min_singular_value(q, arm)


def suggest_move(
    tool_path: ToolPath, candidate: Candidate, node: int, margin: FaultMargin, shortfall: float
) -> Suggestion:
    """Suggest the shortest tried move of one control point after which a margin at a node suffices.

    Args:
        tool_path: what the tool is to follow.
        candidate: the branch and roll of the tool.
        node: index of the node.
        margin: that must grow.
        shortfall: by how much it must grow.
    """
    shares = control_point_weights(tool_path.curve, float(tool_path.parameters[node]))
    point = int(np.argmax(shares))
    measure = _MarginNearNode(tool_path, candidate, node, margin)
    moves = _moves(measure)
    values = measure(moves) - measure(np.zeros((1, 3)))[0]
    enough = np.flatnonzero(values >= shortfall)
    best = min(enough, key=lambda k: float(np.linalg.norm(moves[k])), default=int(np.argmax(values)))
    move = moves[best] / shares[point]
    x, y, z = (float(v) for v in move)
    about = max(5 * round(200 * float(np.linalg.norm(move))), 5)
    far = f"by about {about} mm" if len(enough) else f"by more than {about} mm"
    sentence = f"move control point {point + 1} of {len(shares)} {far} {describe_direction((x, y, z))}"
    return Suggestion(point, (x, y, z), sentence)


def _moves(measure: _MarginNearNode) -> Array:
    """Return trial moves of the tool (m, 3) [m]: up the margin's slope, and along the axes."""
    slope = measure.slope()
    directions = [*np.eye(3), *-np.eye(3)]
    if (steepness := float(np.linalg.norm(slope))) > MIN_SLOPE:
        directions.append(slope / steepness)
    return np.concatenate([far * np.array(directions) for far in TRIED_DISTANCES])


@dataclass(frozen=True, eq=False)
class _MarginNearNode:
    """The margin after moves of the tool from a node, with the same orientation, on the same branch."""

    tool_path: ToolPath
    candidate: Candidate
    node: int
    margin: FaultMargin

    def __call__(self, moves: Array) -> Array:
        """Return the margin (m,) after moves (m, 3) [m]."""
        poses = np.repeat(
            self.tool_path.poses(self.tool_path.parameters[self.node : self.node + 1]), len(moves), axis=0
        )
        poses[:, :3, 3] += moves
        here, arm = self.candidate.joints[self.node], self.candidate.branch.arm
        roll = self.candidate.roll(self.tool_path.parameters[self.node : self.node + 1])
        wanted = rolled_poses(poses, roll, arm)
        if arm.model is not None:
            near, off = solve_near(wanted, np.repeat(here[None], len(wanted), axis=0), arm.model)
            return self.margin(near, np.where(off <= POSE_TOLERANCE, 0.0, off))
        solutions = inverse_kinematics(wanted, arm, previous_q4=float(here[3]))
        q = roll_tool(solutions.joints[:, self.candidate.branch.index], roll, arm)
        return self.margin(q + 2 * np.pi * np.round((here - q) / (2 * np.pi)), solutions.reach_excess[:, 0])

    def slope(self) -> Array:
        """Return the slope (3,) of the margin."""
        values = self(PROBE_DISTANCE * np.concatenate([np.eye(3), -np.eye(3)]))
        return np.asarray((values[:3] - values[3:]) / (2 * PROBE_DISTANCE), dtype=np.float64)


def margin_shortfall(fault: str, candidate: Candidate, node: int, settings: MotionSettings) -> float:
    """Return by how much the margin of a fault is too small at a node."""
    if fault == "reach":
        return float(candidate.branch.reach_excess[node])
    if fault == "limit":
        return float(candidate.limit_excess[node].max())
    if fault == "turn":
        return 0.1
    return settings.least_singular - float(candidate.singular_values[node])
