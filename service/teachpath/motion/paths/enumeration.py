"""Enumerates the candidates of a path: every branch of inverse kinematics with every constant roll of the settings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from teachpath.motion.arm.model import Arm
from teachpath.motion.paths.ik_branches import (
    Candidate,
    IkBranch,
    ToolRoll,
    candidate_of,
    closed_branches,
    jumps,
    rolled_poses,
)
from teachpath.motion.paths.numeric_branches import TrackedSolution, track_solutions
from teachpath.motion.paths.redundancy import UNREACHABLE_COST, Redundancy, Sheet, find_sheets
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.settings import MotionSettings
from teachpath.records import SerialArm

POSE_COUNT: Final = 6  # numbers of a pose; an arm with more joints has some left


def enumerate_candidates(path: ToolPath, arm: Arm, settings: MotionSettings) -> list[Candidate]:
    """Return a candidate for every branch of `arm` and every constant roll of the settings, along a tool path."""
    rolls = [ToolRoll(angle) for angle in settings.rolls]
    if arm.rolls_by_joint_6:
        return [candidate_of(path, branch, roll) for branch in closed_branches(path, arm, ToolRoll()) for roll in rolls]
    if arm.model is not None:
        return _numeric_candidates(path, arm, arm.model, rolls, settings)
    each = zip(*[closed_branches(path, arm, roll) for roll in rolls], strict=True)
    return [candidate_of(path, branch, roll) for same in each for branch, roll in zip(same, rolls, strict=True)]


def redundant_candidate(
    path: ToolPath, arm: Arm, model: SerialArm, number: int, sheet: Sheet, sequence: NDArray[np.int64], roll: ToolRoll
) -> Candidate:
    """Return the candidate of an arm with seven joints that follows a sequence through a sheet.

    Args:
        path: what the tool is to follow.
        arm: whose sheet it is.
        model: that describes it.
        number: of the sheet.
        sheet: see `redundancy`.
        sequence: (m,) numbers of the redundant joint's angles at the sheet's nodes.
        roll: of the tool.
    """
    poses = rolled_poses(path.poses(path.parameters), roll(path.parameters), arm)
    angle = sheet.smoothed(sequence, path.parameters)
    found = sheet.tracked(sequence, angle(path.parameters), poses, model)
    branch = _branch(arm, number, found, Redundancy(sheet, angle))
    return candidate_of(path, branch, roll)


def _numeric_candidates(
    path: ToolPath, arm: Arm, model: SerialArm, rolls: Sequence[ToolRoll], settings: MotionSettings
) -> list[Candidate]:
    poses = path.poses(path.parameters)
    ways = [rolled_poses(poses, roll(path.parameters), arm) for roll in rolls]
    found = list[Candidate]()
    for number, sheet in enumerate(find_sheets(ways, model) if arm.joint_count > POSE_COUNT else ()):
        # where none is free, one that is blocked least
        costs = np.minimum(sheet.costs(arm, settings, path.posture), UNREACHABLE_COST)
        if (sequence := sheet.cheapest(costs)) is not None:
            found.append(redundant_candidate(path, arm, model, number, sheet, sequence, rolls[sheet.way]))
    if found:
        return found
    every = enumerate(track_solutions(ways, model))
    return [candidate_of(path, _branch(arm, number, each), rolls[each.way]) for number, each in every]


def _branch(arm: Arm, number: int, found: TrackedSolution, redundancy: Redundancy | None = None) -> IkBranch:
    nearer = np.zeros(len(found.joints), dtype=np.bool_)
    return IkBranch(arm, number, found.joints, found.excess, nearer, jumps(found.joints), redundancy)
