"""How near the tool comes to where a hand leads it, and what gives way where it cannot follow.

While the tool keeps its orientation, the place gives way: the tool stays short of the hand. Where it follows the hand's
turns, the turn gives way first, and the place only where it cannot be reached with less of a turn either.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.execution.hand_kinematics import HandKinematics

MAX_JOINT_LEAD: Final = 0.25  # [rad] of one motion: more could not be checked in time
POSES_PER_SOLVE: Final = 8  # poses on the way to the target for which inverse kinematics are solved at once
TURN_SHARES: Final = (1.0, 0.5, 0.2, 0.0)  # of the hand's turn that are tried
MAX_JOINT_JUMP: Final = 0.6  # [rad] between two neighbouring poses; a larger turn would be another motion of the arm
MIN_TURN: Final = 1e-6  # [rad] below which the hand asks for no turn

STAYS_SHORT: Final = "so the tool stays short of the hand; move the hand back"
TURNS_LESS: Final = "so the tool turns less than the hand; turn the hand back"


@dataclass(frozen=True, eq=False)
class ReachableGoal:
    """What the tool can reach in one motion.

    Attributes:
        joints: (joints,) [rad].
        turn: (3,) rotation vector of the tool from its orientation at the begin, in axes of the world [rad].
        reason: why it does not go all the way, in words; empty when it does.
        moves: whether it is elsewhere than the begin.
    """

    joints: Array
    turn: Array
    reason: str
    moves: bool = True


@dataclass(frozen=True, eq=False)
class _Way:
    """Poses on a straight way: `share` of the hand's turn, `good` of them reachable from the begin on."""

    share: float
    joints: Array  # (POSES_PER_SOLVE + 1, joints) from the begin on
    good: int
    fault: str


def nearest_reachable(
    begin: Array, pose: Array, move: Array, turn: Array, kinematics: HandKinematics, least_singular: float
) -> ReachableGoal:
    """Return the goal nearest to where the hand leads the tool that is reached from where it is, on one branch.

    Args:
        begin: (joints,) [rad].
        pose: (4, 4) of the tool there, to world from the tool.
        move: (3,) to the target [m, world].
        turn: (3,) rotation vector to the target's orientation, in axes of the world [rad].
        kinematics: of the arm.
        least_singular: value of the Jacobian below which a pose counts as singular.
    """
    shares = TURN_SHARES if np.linalg.norm(turn) > MIN_TURN else (1.0,)
    ways = _ways(begin, pose, move, turn, shares, kinematics, least_singular)
    best = max(ways, key=lambda way: (way.good, way.share))
    if not np.any(np.abs(move) > 1e-6):  # the hand only turns
        best = max(ways, key=lambda way: way.good * way.share)
    reason = _describe(ways[0], best)
    if best.good == 0:
        return ReachableGoal(begin, np.zeros(3), reason, moves=False)
    turned = np.abs(best.joints[1 : best.good + 1] - begin).max(axis=1)
    near = max(int(np.searchsorted(np.maximum.accumulate(turned), MAX_JOINT_LEAD, "right")), 1)
    part = min(1.0, MAX_JOINT_LEAD / max(float(np.abs(best.joints[near] - begin).max()), 1e-12))
    goal = begin + part * (best.joints[near] - begin)
    is_hindered = (best.good < POSES_PER_SOLVE and near >= best.good) or best.share < 1.0
    return ReachableGoal(goal, part * near / POSES_PER_SOLVE * best.share * turn, reason if is_hindered else "")


def _ways(
    begin: Array,
    pose: Array,
    move: Array,
    turn: Array,
    shares: tuple[float, ...],
    kinematics: HandKinematics,
    least_singular: float,
) -> list[_Way]:
    steps = np.arange(1, POSES_PER_SOLVE + 1) / POSES_PER_SOLVE
    poses = np.tile(np.eye(4), (len(shares), POSES_PER_SOLVE, 1, 1))
    turns = (np.array(shares)[:, None, None] * steps[:, None] * turn).reshape(-1, 3)
    poses[..., :3, :3] = (Rotation.from_rotvec(turns).as_matrix() @ pose[:3, :3]).reshape(*poses.shape[:2], 3, 3)
    poses[..., :3, 3] = pose[:3, 3] + steps[:, None] * move
    joints, missed = kinematics.follow(begin, poses)
    singular = kinematics.singular_values(joints[:, 1:]) < least_singular
    return [
        _Way(share, joints[k], *_first_fault(joints[k], missed[k], singular[k], kinematics.arm))
        for k, share in enumerate(shares)
    ]


def _first_fault(joints: Array, out_of_reach: Array, singular: Array, arm: Arm) -> tuple[int, str]:
    """Return how many poses are good, and what is wrong with the next one in words."""
    beyond = np.maximum(joints[1:] - arm.limits.upper, arm.limits.lower - joints[1:])  # (n, joints) of each joint [rad]
    turns = np.abs(np.diff(joints, axis=0)).max(axis=1) > MAX_JOINT_JUMP
    bad = np.array([out_of_reach, beyond.max(axis=1) > 0, singular, turns])
    if not bad.any():
        return len(bad[0]), ""
    good = int(np.argmax(bad.any(axis=0)))
    joint = int(np.argmax(beyond[good]))
    sentences = (
        "the arm does not reach that far",
        describe_limit(joint, joints[good + 1, joint], arm),
        "the arm would come to a singular pose",
        "the arm would have to turn over",
    )
    return good, sentences[int(np.argmax(bad[:, good]))]


def describe_limit(joint: int, angle: float, arm: Arm) -> str:
    """Say that a joint, counted from 0, is at its limit where it would turn to `angle` [rad]."""
    limit = arm.limits.upper[joint] if angle > arm.limits.upper[joint] else arm.limits.lower[joint]
    return f"{arm.limits.names[joint]} is at its limit of {degrees(limit):.0f} degrees"


def _describe(asked: _Way, best: _Way) -> str:
    if best.good < POSES_PER_SOLVE:
        return f"{best.fault}, {STAYS_SHORT}"
    return f"{asked.fault}, {TURNS_LESS}" if best.share < 1.0 else ""
