"""Branches of inverse kinematics along a whole tool path: the candidates of a plan, and their faults node by node."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import degrees
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from teachpath.motion.arm.kinematics import BRANCH_NAMES, describe_reach, inverse_kinematics, min_singular_value
from teachpath.motion.arm.limits import JointLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.settings import MotionSettings

MAX_JOINT_STEP: Final = 0.35  # rad between two nodes; a larger one is a jump, at which the branch ends


@dataclass(frozen=True, eq=False)
class IkBranch:
    """One branch of inverse kinematics along a tool path, before any roll of the tool.

    Attributes:
        arm: whose branch it is.
        index: of shoulder, elbow and wrist in `BRANCH_NAMES`.
        unrolled_joints: (n, 6) configurations [rad]; out of reach, the arm is stretched or folded towards the pose.
        reach_excess: (n,) how far the wrist centre is out of reach [m]; at most 0 within reach.
        beyond_outer_reach: (n,) True where it is too far away, False where it is too near to the arm's axis.
        jumps: (n,) True where a joint jumps between a node and the next.
    """

    arm: Arm
    index: int
    unrolled_joints: Array
    reach_excess: Array
    beyond_outer_reach: NDArray[np.bool_]
    jumps: NDArray[np.bool_]

    @cached_property
    def singular_values(self) -> Array:
        """Least singular value of the Jacobian (n,); joint 6 does not change it."""
        return min_singular_value(self.unrolled_joints, self.arm)


@dataclass(frozen=True, eq=False)
class ToolRoll:
    """The roll of the tool about its own axis: one angle, or a function of the curve's parameter.

    Attributes:
        angle: constant roll [rad]; used where there is no spline.
        spline: angle [rad] as a function of the curve's parameter.
    """

    angle: float = 0.0
    spline: BSpline[np.float64] | None = None

    def __call__(self, u: Array) -> Array:
        """Return the angles (m,) [rad] at the curve's parameters (m,)."""
        angles = np.full(len(u), self.angle) if self.spline is None else self.spline(u)
        return np.asarray(angles, dtype=np.float64)

    def __str__(self) -> str:
        """Describe the roll in words."""
        return f"roll {degrees(self.angle):.0f} deg" if self.spline is None else "rolling"


@dataclass(frozen=True, eq=False)
class Candidate:
    """A branch with a roll of the tool: continuous configurations of the arm along a whole tool path.

    Attributes:
        description: shoulder, elbow, wrist and tool roll in words.
        branch: of inverse kinematics, which does not depend on the roll.
        roll: of the tool about its own axis.
        joints: (n, 6) continuous configurations [rad].
        limit_excess: (n, 6) by how much each joint is beyond its limit [rad]; negative within.
    """

    description: str
    branch: IkBranch
    roll: ToolRoll
    joints: Array
    limit_excess: Array

    @property
    def singular_values(self) -> Array:
        """Least singular value of the Jacobian (n,)."""
        return self.branch.singular_values

    @property
    def min_singular_value(self) -> float:
        """Least singular value on the whole path."""
        return float(self.singular_values.min())

    @property
    def feasible(self) -> bool:
        """Whether all poses are reached within the joint limits and without a jump."""
        branch = self.branch
        return bool(branch.reach_excess.max() <= 0 and self.limit_excess.max() <= 0 and not branch.jumps.any())


def enumerate_candidates(path: ToolPath, arm: Arm, settings: MotionSettings) -> list[Candidate]:
    """Return a candidate for every branch of `arm` and every constant roll of the settings, along a tool path."""
    solutions = inverse_kinematics(path.poses(path.parameters), arm)
    outside = solutions.reach_excess[:, 0]
    found = []
    for index, name in enumerate(BRANCH_NAMES):
        unrolled = np.unwrap(solutions.joints[:, index], axis=0)
        jumps = np.append(np.abs(np.diff(unrolled, axis=0)).max(axis=1) > MAX_JOINT_STEP, False)
        branch = IkBranch(arm, index, unrolled, outside, solutions.beyond_outer_reach, jumps)
        found += [rolled_candidate(path, name, branch, ToolRoll(angle)) for angle in settings.rolls]
    return found


def rolled_candidate(path: ToolPath, name: str, branch: IkBranch, roll: ToolRoll) -> Candidate:
    """Return the candidate of a branch with a roll of the tool; `name` is that of the branch."""
    limits = branch.arm.limits
    joints = shift_within_limits(roll_tool(branch.unrolled_joints, roll(path.parameters)), limits)
    excess = np.maximum(joints - limits.upper, limits.lower - joints)
    return Candidate(f"{name}, {roll}", branch, roll, joints, excess)


def configurations(path: ToolPath, candidate: Candidate, u: Array) -> Array:
    """Return the configurations (m, 6) of a candidate at parameters (m,) that increase from the start of its curve."""
    unrolled = np.unwrap(
        inverse_kinematics(path.poses(u), candidate.branch.arm).joints[:, candidate.branch.index], axis=0
    )
    return shift_near(roll_tool(unrolled, candidate.roll(u)), candidate.joints[0])


def roll_tool(joints: Array, roll: Array) -> Array:
    """Roll the tool about its own axis by `roll` (...,) [rad]: joint 6 turns by the opposite angle."""
    turned = joints.copy()
    turned[..., 5] -= roll
    return turned


def shift_near(joints: Array, first: Array) -> Array:
    """Shift each joint of continuous configurations (m, 6) by whole turns, to begin nearest to `first` (6,)."""
    return np.asarray(joints + 2 * np.pi * np.round((first - joints[0]) / (2 * np.pi)), dtype=np.float64)


def shift_within_limits(joints: Array, limits: JointLimits) -> Array:
    """Shift each joint of continuous configurations (n, 6) by whole turns, nearest to the middle of its range."""
    middle = (joints.max(axis=0) + joints.min(axis=0)) / 2
    turns = np.round(((limits.lower + limits.upper) / 2 - middle) / (2 * np.pi))
    return np.asarray(joints + 2 * np.pi * turns, dtype=np.float64)


def node_faults(candidate: Candidate, settings: MotionSettings) -> NDArray[np.str_]:
    """Return the fault at each node (n,): `reach`, `limit`, `turn` of the wrist, `singular`, or empty."""
    named = np.full(len(candidate.joints), "", dtype="<U9")
    named[candidate.singular_values < settings.least_singular] = "singular"
    named[candidate.branch.jumps] = "turn"
    named[candidate.limit_excess.max(axis=1) > 0] = "limit"
    named[candidate.branch.reach_excess > 0] = "reach"
    return named


def is_usable(candidate: Candidate, settings: MotionSettings) -> bool:
    """Return whether a candidate reaches all poses within the joint limits, without a jump and never singular."""
    return candidate.feasible and candidate.min_singular_value >= settings.least_singular


def cost(candidate: Candidate, settings: MotionSettings) -> float:
    """Return the cost of a candidate: low far from singular poses and joint limits, and near to the arm's home.

    A second of travel from home costs 0.2.
    """
    limits = candidate.branch.arm.limits
    middle, half = (limits.lower + limits.upper) / 2, (limits.upper - limits.lower) / 2
    use = np.abs(candidate.joints - middle).max(axis=0) / half
    travel = np.abs(candidate.joints[0] - np.array(settings.home)) / limits.speed
    return float(0.1 / candidate.min_singular_value + use.max() + 0.2 * travel.max())


def nearest_to_usable(every: Sequence[Candidate]) -> Candidate:
    """Return the candidate with the fewest nodes beyond limits or at a jump, and of those the least singular one."""
    wrong = [np.count_nonzero((c.limit_excess.max(axis=1) > 0) | c.branch.jumps) for c in every]
    fewest = [c for c, count in zip(every, wrong, strict=True) if count == min(wrong)]
    return max(fewest, key=lambda c: c.min_singular_value)


def describe_fault(candidate: Candidate, path: ToolPath, node: int, fault: str, settings: MotionSettings) -> str:
    """Describe the fault at a node, and where it is."""
    where = path.describe_node(node)
    if fault == "reach":
        s = float(path.lengths[node])
        return describe_reach(
            float(candidate.branch.reach_excess[node]), bool(candidate.branch.beyond_outer_reach[node]), s
        )
    if fault == "limit":
        joint = int(np.argmax(candidate.limit_excess[node]))
        angle = candidate.joints[node, joint]
        limits = candidate.branch.arm.limits
        limit = limits.upper[joint] if angle > limits.upper[joint] else limits.lower[joint]
        return (
            f"joint {joint + 1} needs {degrees(angle):.1f} deg, limit {degrees(limit):.1f}, {where} "
            f"({candidate.description} comes nearest)"
        )
    if fault == "turn":
        return f"the wrist would have to turn over {where} ({candidate.description})"
    return (
        f"the arm is nearly singular (least singular value {candidate.singular_values[node]:.3f}, limit "
        f"{settings.least_singular:g}) {where} ({candidate.description})"
    )
