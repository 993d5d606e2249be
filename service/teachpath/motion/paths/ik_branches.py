"""Every way in which the arm can hold its tool along a whole route, and what is wrong with it, node by node."""

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

# A joint that turns more than this between two nodes has jumped: the branch ends there.
MAX_JOINT_STEP: Final = 0.35  # rad


@dataclass(frozen=True, eq=False)
class IkBranch:
    """What the rolls of one branch share.

    Attributes:
        arm: whose branch it is.
        index: of shoulder, elbow and wrist in `BRANCHES`.
        unrolled: (n, 6) configurations before any roll of the tool [rad]; where the arm does not reach, its nearest
            stretch.
        outside: (n,) how far the wrist centre is out of reach [m]; at most 0 within.
        beyond: (n,) True where it is too far away, False where too near to the arm's axis.
        jumps: (n,) True where a joint jumps from a node to the next.
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
    """How the tool is rolled about its own axis: by one angle, or from place to place.

    Attributes:
        angle: [rad] all the way, when there is no spline.
        spline: angles by the curve's parameter.
    """

    angle: float = 0.0
    spline: BSpline[np.float64] | None = None

    def __call__(self, u: Array) -> Array:
        """Return the angles (m,) [rad] at the curve's parameters (m,)."""
        angles = np.full(len(u), self.angle) if self.spline is None else self.spline(u)
        return np.asarray(angles, dtype=np.float64)

    def __str__(self) -> str:
        """Say it in words."""
        return f"roll {degrees(self.angle):.0f} deg" if self.spline is None else "rolling"


@dataclass(frozen=True, eq=False)
class Candidate:
    """One way to hold the arm along a whole route.

    Attributes:
        branch: shoulder, elbow, wrist and tool roll in words.
        arm: what does not depend on the roll.
        roll: of the tool about its own axis.
        joints: (n, 6) continuous configurations [rad].
        over: (n, 6) by how much each joint is beyond its limit [rad]; negative within.
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
        """Least singular value on the whole route."""
        return float(self.singular_values.min())

    @property
    def feasible(self) -> bool:
        """Whether everything is reached within the joint limits and without a jump."""
        arm = self.branch
        return bool(arm.reach_excess.max() <= 0 and self.limit_excess.max() <= 0 and not arm.jumps.any())


def enumerate_candidates(path: ToolPath, arm: Arm, settings: MotionSettings) -> list[Candidate]:
    """Find every branch and tool roll along a route, with how well each does."""
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
    """Return what becomes of an arm's branch along a route when the tool is rolled."""
    limits = branch.arm.limits
    joints = shift_within_limits(roll_tool(branch.unrolled_joints, roll(path.parameters)), limits)
    excess = np.maximum(joints - limits.upper, limits.lower - joints)
    return Candidate(f"{name}, {roll}", branch, roll, joints, excess)


def configurations(path: ToolPath, candidate: Candidate, u: Array) -> Array:
    """Return the configurations (m, 6) of a candidate at increasing parameters (m,) of its curve, from its start."""
    unrolled = np.unwrap(
        inverse_kinematics(path.poses(u), candidate.branch.arm).joints[:, candidate.branch.index], axis=0
    )
    return shift_near(roll_tool(unrolled, candidate.roll(u)), candidate.joints[0])


def roll_tool(joints: Array, roll: Array) -> Array:
    """Turn the tool about its own axis by `roll` (...,) [rad]: joint 6 alone, the other way round."""
    turned = joints.copy()
    turned[..., 5] -= roll
    return turned


def shift_near(joints: Array, first: Array) -> Array:
    """Shift each joint of continuous configurations (m, 6) by whole turns, so that they begin near to `first` (6,)."""
    return np.asarray(joints + 2 * np.pi * np.round((first - joints[0]) / (2 * np.pi)), dtype=np.float64)


def shift_within_limits(joints: Array, limits: JointLimits) -> Array:
    """Shift each joint of continuous configurations (n, 6) by whole turns, nearest to the middle of its range."""
    middle = (joints.max(axis=0) + joints.min(axis=0)) / 2
    turns = np.round(((limits.lower + limits.upper) / 2 - middle) / (2 * np.pi))
    return np.asarray(joints + 2 * np.pi * turns, dtype=np.float64)


def node_faults(candidate: Candidate, settings: MotionSettings) -> NDArray[np.str_]:
    """Name what is wrong at each node (n,): `reach`, `limit`, `turn` of the wrist, `singular`; empty when nothing."""
    named = np.full(len(candidate.joints), "", dtype="<U9")
    named[candidate.singular_values < settings.least_singular] = "singular"
    named[candidate.branch.jumps] = "turn"
    named[candidate.limit_excess.max(axis=1) > 0] = "limit"
    named[candidate.branch.reach_excess > 0] = "reach"
    return named


def is_usable(candidate: Candidate, settings: MotionSettings) -> bool:
    """Tell whether a candidate reaches everything, keeps the joint limits, has no jump and no singular pose."""
    return candidate.feasible and candidate.min_singular_value >= settings.least_singular


def cost(candidate: Candidate, settings: MotionSettings) -> float:
    """Prefer branches far from singular poses and joint limits, and near to the arm's home (a second counts 0.2)."""
    limits = candidate.branch.arm.limits
    middle, half = (limits.lower + limits.upper) / 2, (limits.upper - limits.lower) / 2
    use = np.abs(candidate.joints - middle).max(axis=0) / half
    travel = np.abs(candidate.joints[0] - np.array(settings.home)) / limits.speed
    return float(0.1 / candidate.min_singular_value + use.max() + 0.2 * travel.max())


def nearest_to_usable(every: Sequence[Candidate]) -> Candidate:
    """Choose the candidate with the fewest nodes beyond limits or before a jump; among equals the best conditioned."""
    wrong = [np.count_nonzero((c.limit_excess.max(axis=1) > 0) | c.branch.jumps) for c in every]
    fewest = [c for c, count in zip(every, wrong, strict=True) if count == min(wrong)]
    return max(fewest, key=lambda c: c.min_singular_value)


def describe_fault(candidate: Candidate, path: ToolPath, node: int, fault: str, settings: MotionSettings) -> str:
    """Say what is wrong at a node, and where."""
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
