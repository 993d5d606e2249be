"""Where a path fails, which control point to move, which way and how far: found by moving the tool a little."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.motion.arm.kinematics import inverse_kinematics, min_singular_value
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.paths.ik_branches import Candidate, roll_tool
from teachpath.motion.paths.tool_path import ToolPath, control_point_weights
from teachpath.motion.settings import MotionSettings
from teachpath.records import Suggestion, Vector

PROBE_DISTANCE: Final = 0.004  # m, by which the tool is moved to see what becomes better
MIN_SLOPE: Final = 1e-9  # slope of a margin that shows no way
TRIED_DISTANCES: Final = (0.005, 0.01, 0.015, 0.02, 0.03, 0.04, 0.06, 0.08, 0.12, 0.16, 0.24)  # m
# Seen from the robot: x ahead, y to its left, z up.
DIRECTION_WORDS: Final = (("away from the robot", "towards the robot"), ("to the left", "to the right"), ("up", "down"))
NAMED_COMPONENT_SHARE: Final = 0.45  # share of the largest component from which on another is named as well

# How good some configurations (m, 6) are, reached from poses whose wrist lies (m,) [m] out of reach: (m,), growing.
FaultMargin = Callable[[Array, Array], Array]


def fault_margin(fault: str, candidate: Candidate, node: int) -> FaultMargin:
    """Return what to raise so that a fault of a branch (see `branches.faults`) goes away."""
    arm = candidate.branch.arm
    if fault == "reach":
        return lambda q, outside: -outside
    if fault == "limit":
        joint = int(np.argmax(candidate.limit_excess[node]))
        limits = arm.limits
        return lambda q, outside: np.minimum(limits.upper - q, q - limits.lower)[:, joint]
    if fault == "turn":
        return lambda q, outside: np.abs(np.sin(q[:, 4]))
    return lambda q, outside: min_singular_value(q, arm)


def suggest_move(
    tool_path: ToolPath, candidate: Candidate, node: int, margin: FaultMargin, shortfall: float
) -> Suggestion:
    """Propose a move of one control point after which a margin at a node suffices: the shortest of those tried.

    Args:
        way: the route.
        candidate: branch of the arm.
        node: where on the route.
        margin: what to raise.
        lacking: how much of it is missing.
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
    sentence = f"move control point {point + 1} of {len(shares)} {far} {_direction((x, y, z))}"
    return Suggestion(point, (x, y, z), sentence)


def _moves(measure: _MarginNearNode) -> Array:
    """Return what to try (m, 3): up the margin's slope, and along the axes."""
    slope = measure.slope()
    ways = [*np.eye(3), *-np.eye(3)]
    if (steepness := float(np.linalg.norm(slope))) > MIN_SLOPE:
        ways.append(slope / steepness)
    return np.concatenate([far * np.array(ways) for far in TRIED_DISTANCES])


@dataclass(frozen=True, eq=False)
class _MarginNearNode:
    """The margin with the tool moved from a node, turned neither way, on the same branch."""

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
        here = self.candidate.joints[self.node]
        solutions = inverse_kinematics(poses, self.candidate.branch.arm, previous_q4=float(here[3]))
        roll = self.candidate.roll(self.tool_path.parameters[self.node : self.node + 1])
        q = roll_tool(solutions.joints[:, self.candidate.branch.index], roll)
        return self.margin(q + 2 * np.pi * np.round((here - q) / (2 * np.pi)), solutions.reach_excess[:, 0])

    def slope(self) -> Array:
        """Return the slope (3,) of the margin."""
        values = self(PROBE_DISTANCE * np.concatenate([np.eye(3), -np.eye(3)]))
        return np.asarray((values[:3] - values[3:]) / (2 * PROBE_DISTANCE), dtype=np.float64)


def margin_shortfall(fault: str, candidate: Candidate, node: int, settings: MotionSettings) -> float:
    """Return by how much the margin of a fault falls short at a node."""
    if fault == "reach":
        return float(candidate.branch.reach_excess[node])
    if fault == "limit":
        return float(candidate.limit_excess[node].max())
    if fault == "turn":
        return 0.1
    return settings.least_singular - float(candidate.singular_values[node])


def _direction(move: Vector) -> str:
    largest = max(abs(v) for v in move)
    named = sorted(
        (-abs(value), ways[0] if value > 0 else ways[1])
        for value, ways in zip(move, DIRECTION_WORDS, strict=True)
        if abs(value) >= NAMED_COMPONENT_SHARE * largest
    )
    return " and ".join(words for _, words in named)
