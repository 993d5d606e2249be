"""Searches for a motion of the redundant joint with which an arm of seven joints keeps clear of everything."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.collision_model import CollisionModel, grasped_load
from teachpath.motion.paths.enumeration import redundant_candidate
from teachpath.motion.paths.ik_branches import Candidate, is_usable
from teachpath.motion.paths.redundancy import Sheet
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.planning.clearance import CLEARANCE_WEIGHT, SMOOTHING_CLEARANCE, SUFFICIENT_CLEARANCE
from teachpath.motion.settings import MotionSettings

COARSE_STRIDE: Final = 3  # search nodes of the first, coarse search


def swivelled_candidates(
    tool_path: ToolPath, usable: list[Candidate], model: CollisionModel, settings: MotionSettings
) -> list[Candidate]:
    """Return candidates that keep clear at the nodes of their sheets, one for each sheet where there is one.

    Args:
        tool_path: what the tool is to follow.
        usable: candidates that fulfil everything but the clearance.
        model: of arm and scene.
        settings: clearance to keep.
    """
    arm, found = model.arm, []
    for candidate in usable:
        if arm.model is None or (redundancy := candidate.branch.redundancy) is None:
            continue
        sheet, number = redundancy.sheet, candidate.branch.index
        if (sequence := _clear_sequence(sheet, candidate, tool_path, model, settings)) is not None:
            found.append(redundant_candidate(tool_path, arm, arm.model, number, sheet, sequence, candidate.roll))
    return [candidate for candidate in found if is_usable(candidate, settings)]


def _clear_sequence(
    sheet: Sheet, candidate: Candidate, tool_path: ToolPath, model: CollisionModel, settings: MotionSettings
) -> NDArray[np.int64] | None:
    costs = sheet.costs(model.arm, settings, tool_path.posture)
    rows = np.arange(len(costs))
    coarse = rows % COARSE_STRIDE == 0
    _add_clearances(costs, coarse, sheet, candidate, model, settings)
    # A sequence through all nodes is one through some of them too; mostly these suffice to see that there is none.
    if sheet.cheapest(costs[coarse], COARSE_STRIDE) is None:
        return None
    _add_clearances(costs, ~coarse, sheet, candidate, model, settings)
    return sheet.cheapest(costs)


def _add_clearances(
    costs: Array, rows: NDArray[np.bool_], sheet: Sheet, candidate: Candidate, model: CollisionModel,
    settings: MotionSettings,
) -> None:  # fmt: skip
    """Add what a missing clearance costs in rows (m,) of costs (m, k), and make those infinite that are too near."""
    free = np.isfinite(costs) & rows[:, None]
    load = grasped_load(model, candidate.joints[0])
    clear = np.array([row.distance for row in model.clearances(sheet.joints[free], load=load)])
    missing = CLEARANCE_WEIGHT * np.maximum(SUFFICIENT_CLEARANCE - clear, 0.0)
    costs[free] += np.where(clear >= settings.clearance_min + SMOOTHING_CLEARANCE, missing, np.inf)
