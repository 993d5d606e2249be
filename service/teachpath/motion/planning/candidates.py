"""Which branch and roll of the tool a path is followed with: what a plan and a quick look at a path have in common."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.paths.ik_branches import Candidate, cost, is_usable
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.planning.clearance import rough_clearance
from teachpath.motion.planning.tool_roll import rolling_candidates
from teachpath.motion.settings import MotionSettings

# A branch and roll that keeps more clearance is worth so much per metre, up to what is enough.
CLEARANCE_GAIN: Final = 20.0
SUFFICIENT_CLEARANCE: Final = 0.02  # m


def usable_candidates(every: Sequence[Candidate], settings: MotionSettings) -> list[Candidate]:
    """Return the candidates that reach everything, keep the joint limits and are never singular, the best first."""
    fit = [candidate for candidate in every if is_usable(candidate, settings)]
    return sorted(fit, key=lambda candidate: cost(candidate, settings))


def clear_candidates(
    tool_path: ToolPath, usable: list[Candidate], model: CollisionModel, settings: MotionSettings
) -> list[Candidate]:
    """Return the candidates that keep clear of everything, best by cost and clearance first.

    Where none with one roll of the tool does, those whose tool rolls along the path. What is far costlier than one with
    enough clearance is left out.

    Args:
        way: the route.
        fit: candidates, the best first (see `fitting`).
        model: of the scene.
        settings: clearance to keep.
    """
    free = _with_clearance(tool_path, usable, model, settings) or _with_clearance(
        tool_path, rolling_candidates(tool_path, usable, model, settings), model, settings
    )
    return [candidate for _, candidate in sorted(free, key=lambda trial: trial[0])]


def _with_clearance(
    tool_path: ToolPath, usable: list[Candidate], model: CollisionModel, settings: MotionSettings
) -> list[tuple[float, Candidate]]:
    """Return the candidates that keep clear, with what they cost less what their clearance is worth."""
    free: list[tuple[float, Candidate]] = []
    for candidate in usable:
        clearance = rough_clearance(tool_path, candidate, model, settings).value
        if clearance >= settings.clearance_min:
            free.append((cost(candidate, settings) - CLEARANCE_GAIN * min(clearance, SUFFICIENT_CLEARANCE), candidate))
        if clearance >= SUFFICIENT_CLEARANCE:
            break  # all that follow cost more
    return free
