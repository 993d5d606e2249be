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

from teachpath.lengths import describe_length
from teachpath.motion.arm.kinematics import BRANCH_NAMES, describe_reach, inverse_kinematics, min_singular_value
from teachpath.motion.arm.limits import JointLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.serial_ik import nearest_turn
from teachpath.motion.paths.numeric_branches import follow_near
from teachpath.motion.paths.posture import posture_cost
from teachpath.motion.paths.redundancy import Redundancy
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.settings import MotionSettings

MAX_JOINT_STEP: Final = 0.35  # rad between two nodes; a larger one is a jump, at which the branch ends


@dataclass(frozen=True, eq=False)
class IkBranch:
    """One branch of inverse kinematics along a tool path.

    Attributes:
        arm: whose branch it is.
        index: of shoulder, elbow and wrist in `BRANCH_NAMES`; of a user's model, of the solution at the path's start.
        joints: (n, joints) configurations [rad], before any roll of the tool where joint 6 alone rolls it (see
            `rolled_poses`); out of reach, the arm is stretched or folded towards the pose.
        reach_excess: (n,) how far the wrist centre is out of reach [m]; at most 0 within reach.
        beyond_outer_reach: (n,) True where it is too far away, False where it is too near to the arm's axis.
        jumps: (n,) True where a joint jumps between a node and the next.
        redundancy: how the joint moves that an arm with seven joints has left; None: the arm has none left.
    """

    arm: Arm
    index: int
    joints: Array
    reach_excess: Array
    beyond_outer_reach: NDArray[np.bool_]
    jumps: NDArray[np.bool_]
    redundancy: Redundancy | None = None

    @property
    def name(self) -> str:
        """Shoulder, elbow and wrist in words; of a user's model, the number of the solution and the model."""
        if self.arm.model is None:
            return BRANCH_NAMES[self.index]
        return f"{self.arm.identity} solution {self.index + 1}"

    @cached_property
    def singular_values(self) -> Array:
        """Least singular value of the Jacobian (n,); a roll by joint 6 alone does not change it."""
        return min_singular_value(self.joints, self.arm)


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
        branch: of inverse kinematics.
        roll: of the tool about its own axis.
        joints: (n, joints) continuous configurations [rad].
        limit_excess: (n, joints) by how much each joint is beyond its limit [rad]; negative within.
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


def rolled_candidate(path: ToolPath, branch: IkBranch, roll: ToolRoll) -> Candidate:
    """Return the candidate of a branch with another roll of the tool."""
    if not branch.arm.rolls_by_joint_6:
        branch = closed_branches(path, branch.arm, roll)[branch.index]
    return candidate_of(path, branch, roll)


def configurations(path: ToolPath, candidate: Candidate, u: Array) -> Array:
    """Return the configurations (m, joints) of a candidate at parameters (m,) that increase from its start."""
    arm, roll = candidate.branch.arm, candidate.roll(u)
    if arm.model is not None:
        seeds, held = np.stack([np.interp(u, path.parameters, joint) for joint in candidate.joints.T], axis=1), None
        if (redundancy := candidate.branch.redundancy) is not None:
            held = redundancy.sheet.joint
            seeds[:, held] = nearest_turn(redundancy.angle(u), seeds[:, held])
        return follow_near(rolled_poses(path.poses(u), roll, arm), seeds, arm.model, held=held)
    solutions = inverse_kinematics(rolled_poses(path.poses(u), roll, arm), arm)
    continuous = np.unwrap(solutions.joints[:, candidate.branch.index], axis=0)
    return shift_near(roll_tool(continuous, roll, arm), candidate.joints[0])


def rolled_poses(poses: Array, roll: Array, arm: Arm) -> Array:
    """Return the poses (..., 4, 4) that inverse kinematics solves for, with the tool rolled by `roll` (...,) [rad].

    Where joint 6 alone rolls the tool, they are the poses themselves, and `roll_tool` turns joint 6 afterwards.
    """
    if arm.rolls_by_joint_6:
        return poses
    turned = poses.copy()
    c, s = np.cos(roll)[..., None], np.sin(roll)[..., None]
    turned[..., :3, 0] = c * poses[..., :3, 0] - s * poses[..., :3, 1]
    turned[..., :3, 1] = s * poses[..., :3, 0] + c * poses[..., :3, 1]
    return turned


def roll_tool(joints: Array, roll: Array, arm: Arm) -> Array:
    """Roll the tool about its own axis by `roll` (...,) [rad], where joint 6 does it: by the opposite angle.

    Args:
        joints: (..., 6) that solve `rolled_poses` [rad].
    """
    turned = joints.copy()
    if arm.rolls_by_joint_6:
        turned[..., 5] -= roll
    return turned


def closed_branches(path: ToolPath, arm: Arm, roll: ToolRoll) -> list[IkBranch]:
    """Return every branch of an arm along a path, with the tool rolled where joint 6 alone does not roll it."""
    poses = rolled_poses(path.poses(path.parameters), roll(path.parameters), arm)
    solutions = inverse_kinematics(poses, arm)
    outside, found = solutions.reach_excess[:, 0], []
    for index in range(len(BRANCH_NAMES)):
        joints = np.unwrap(solutions.joints[:, index], axis=0)
        found.append(IkBranch(arm, index, joints, outside, solutions.beyond_outer_reach, jumps(joints)))
    return found


def jumps(joints: Array) -> NDArray[np.bool_]:
    """Return (n,) where a joint of configurations (n, joints) jumps between a node and the next."""
    return np.append(np.abs(np.diff(joints, axis=0)).max(axis=1) > MAX_JOINT_STEP, False)


def candidate_of(path: ToolPath, branch: IkBranch, roll: ToolRoll) -> Candidate:
    """Return the candidate of a branch with a roll of the tool."""
    limits = branch.arm.limits
    turned = roll_tool(branch.joints, roll(path.parameters), branch.arm)
    joints = shift_within_limits(turned, limits, path.posture)
    excess = np.maximum(joints - limits.upper, limits.lower - joints)
    return Candidate(f"{branch.name}, {roll}", branch, roll, joints, excess)


def shift_near(joints: Array, first: Array) -> Array:
    """Shift each joint of continuous configurations (m, joints) by whole turns, to begin nearest to `first`."""
    return np.asarray(joints + 2 * np.pi * np.round((first - joints[0]) / (2 * np.pi)), dtype=np.float64)


def shift_within_limits(joints: Array, limits: JointLimits, posture: Array | None = None) -> Array:
    """Shift each joint of continuous configurations (n, joints) by whole turns, nearest to the middle of its range.

    Where joints (n, joints) are preferred, each joint is shifted nearest to these if that is within its limits.
    """
    middle = _middle(joints)
    central = joints + _turns((limits.lower + limits.upper) / 2 - middle)
    if posture is None:
        return np.asarray(central, dtype=np.float64)
    near = joints + _turns(_middle(posture) - middle)
    within = np.all((near >= limits.lower) & (near <= limits.upper), axis=0)
    return np.asarray(np.where(within, near, central), dtype=np.float64)


def _middle(joints: Array) -> Array:
    return np.asarray((joints.max(axis=0) + joints.min(axis=0)) / 2)


def _turns(angles: Array) -> Array:
    return np.asarray(2 * np.pi * np.round(angles / (2 * np.pi)))


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


def cost(candidate: Candidate, settings: MotionSettings, posture: Array | None = None) -> float:
    """Return the cost of a candidate: low far from singular poses and joint limits, and near to the arm's home.

    A second of travel from home costs 0.2. Where joints `posture` (n, joints) are preferred, it is low near these.
    """
    limits = candidate.branch.arm.limits
    middle, half = (limits.lower + limits.upper) / 2, (limits.upper - limits.lower) / 2
    use = np.abs(candidate.joints - middle).max(axis=0) / half
    travel = np.abs(candidate.joints[0] - np.array(settings.home)) / limits.speed
    away = posture_cost(candidate.joints, posture).mean()
    return float(0.1 / candidate.min_singular_value + use.max() + 0.2 * travel.max() + away)


def nearest_to_usable(every: Sequence[Candidate]) -> Candidate:
    """Return the candidate with the fewest nodes beyond limits or at a jump, and of those the least singular one."""
    wrong = [np.count_nonzero((c.limit_excess.max(axis=1) > 0) | c.branch.jumps) for c in every]
    fewest = [c for c, count in zip(every, wrong, strict=True) if count == min(wrong)]
    return max(fewest, key=lambda c: c.min_singular_value)


def describe_fault(candidate: Candidate, path: ToolPath, node: int, fault: str, settings: MotionSettings) -> str:
    """Describe the fault at a node, and where it is."""
    where = path.describe_node(node)
    if fault == "reach":
        s, arm = float(path.lengths[node]), candidate.branch.arm
        if arm.model is not None:
            off = describe_length(float(candidate.branch.reach_excess[node]))
            return f"no configuration of {arm.name} was found that brings the tool nearer than {off} at s = {s:.3f} m"
        return describe_reach(
            float(candidate.branch.reach_excess[node]), bool(candidate.branch.beyond_outer_reach[node]), s
        )
    if fault == "limit":
        joint = int(np.argmax(candidate.limit_excess[node]))
        angle = candidate.joints[node, joint]
        limits = candidate.branch.arm.limits
        limit = limits.upper[joint] if angle > limits.upper[joint] else limits.lower[joint]
        return (
            f"{limits.names[joint]} needs {degrees(angle):.1f} deg, limit {degrees(limit):.1f}, {where} "
            f"({candidate.description} comes nearest)"
        )
    if fault == "turn":
        return f"the wrist would have to turn over {where} ({candidate.description})"
    return (
        f"the arm is nearly singular (least singular value {candidate.singular_values[node]:.3f}, limit "
        f"{settings.least_singular:g}) {where} ({candidate.description})"
    )
