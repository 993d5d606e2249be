"""Chooses the branch and tool roll with which a path is followed; plans and assessments choose alike."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.paths.ik_branches import Candidate, cost, is_usable
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.planning.clearance import SUFFICIENT_CLEARANCE, rough_clearance
from teachpath.motion.planning.redundancy_search import swivelled_candidates
from teachpath.motion.planning.tool_roll import rolling_candidates
from teachpath.motion.settings import MotionSettings
from teachpath.records import Array

CLEARANCE_GAIN: Final = 20.0  # 1/m, by which a metre of clearance lowers the cost, up to `SUFFICIENT_CLEARANCE`


def usable_candidates(
    candidates: Sequence[Candidate], settings: MotionSettings, posture: Array | None = None
) -> list[Candidate]:
    """Return those that reach everything, keep the joint limits and are never singular, the cheapest first.

    Where joints `posture` (n, joints) are preferred, they are cheap near these.
    """
    usable = [candidate for candidate in candidates if is_usable(candidate, settings)]
    return sorted(usable, key=lambda candidate: cost(candidate, settings, posture))


def clear_candidates(
    tool_path: ToolPath, usable: list[Candidate], model: CollisionModel, settings: MotionSettings
) -> list[Candidate]:
    """Return the candidates that keep clear of everything, the best by cost and clearance first.

    Where no candidate with a constant roll of the tool keeps clear, those are tried whose tool rolls along the path, or
    whose redundant joint moves so that they do.
    Candidates that cost more than one with sufficient clearance are left out.

    Args:
        tool_path: what the tool is to follow.
        usable: candidates, the cheapest first (see `usable_candidates`).
        model: of arm and scene.
        settings: clearance to keep.
    """
    ranked = _ranked(tool_path, usable, model, settings)
    if not ranked:
        moving = rolling_candidates if model.arm.model is None else swivelled_candidates
        ranked = _ranked(tool_path, moving(tool_path, usable, model, settings), model, settings)
    return [candidate for _, candidate in sorted(ranked, key=lambda pair: pair[0])]


def _ranked(
    tool_path: ToolPath, usable: list[Candidate], model: CollisionModel, settings: MotionSettings
) -> list[tuple[float, Candidate]]:
    """Return the candidates that keep clear, each with its cost less the worth of its clearance."""
    clear: list[tuple[float, Candidate]] = []
    for candidate in usable:
        clearance = rough_clearance(tool_path, candidate, model, settings).value
        if clearance >= settings.clearance_min:
            worth = CLEARANCE_GAIN * min(clearance, SUFFICIENT_CLEARANCE)
            clear.append((cost(candidate, settings, tool_path.posture) - worth, candidate))
        if clearance >= SUFFICIENT_CLEARANCE:
            break  # the candidates that follow cost more
    return clear
