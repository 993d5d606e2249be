"""Roll the tool from place to place, where no one roll of it leads past everything: a search along the path.

Rolling moves joint 6 alone, so the angles can be chosen when all else is. Places along the path and angles make a grid;
the way through it that keeps clear and turns least is found by dynamic programming and made smooth.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.ndimage import gaussian_filter1d

from teachpath.motion.arm.kinematics import BRANCH_NAMES
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.collision_model import CollisionModel, grasped_load
from teachpath.motion.paths.ik_branches import Candidate, ToolRoll, rolled_candidate
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.planning.clearance import SUFFICIENT_CLEARANCE
from teachpath.motion.settings import MotionSettings

ROLL_COUNT: Final = 24  # of a full turn
ROLL_STEP: Final = 2 * np.pi / ROLL_COUNT  # rad, from one to the next
SEARCH_NODES: Final = 60  # along the path, about
COARSE_STRIDE: Final = 3  # every such place is looked at before the others
MAX_ROLL_STEPS: Final = 2  # of an angle that the tool may turn from a place to the next
SMOOTHING_CLEARANCE: Final = 0.001  # m of clearance above what is asked, for what the smoothing takes
CLEARANCE_WEIGHT: Final = 300.0  # of a missing metre of clearance, beside the square of a turn by one angle
FILTER_WIDTH: Final = 2.0  # places, of the filter that takes the steps out of the angles
SPLINE_DEGREE: Final = 5  # of the angles by the curve's parameter


def rolling_candidates(
    tool_path: ToolPath, usable: list[Candidate], model: CollisionModel, settings: MotionSettings
) -> list[Candidate]:
    """Return candidates whose tool rolls along the path: one a branch, or a first roll of it when it carries something.

    Args:
        way: the route.
        fit: candidates with one roll each that do all that does not depend on the roll.
        model: of the scene.
        settings: clearance to keep.
    """
    found, carries = [], model.scene.carried is not None
    first = {
        (candidate.branch.index, str(candidate.roll) if carries else ""): candidate for candidate in reversed(usable)
    }
    for candidate in first.values():
        if angles := _search_rolls(tool_path, candidate, model, settings):
            roll = ToolRoll(spline=_smoothed(*angles))
            found.append(rolled_candidate(tool_path, BRANCH_NAMES[candidate.branch.index], candidate.branch, roll))
    return [candidate for candidate in found if candidate.feasible]


def _search_rolls(
    tool_path: ToolPath, candidate: Candidate, model: CollisionModel, settings: MotionSettings
) -> tuple[Array, Array] | None:
    """Return places (k,) by the curve's parameter and the angles (k,) [rad] there, or None when nothing leads through.

    What is carried is held as the candidate's own roll takes it at the start.
    """
    nodes = np.unique(np.linspace(0, len(tool_path.lengths) - 1, SEARCH_NODES).round().astype(np.int64))
    more = _roll_steps(candidate.joints[nodes], model.arm)
    few = _roll_costs(model, candidate, nodes[::COARSE_STRIDE], more, settings)
    # What leads through leads through some of the places too: mostly that is enough to see that nothing does.
    if _cheapest_sequence(few, COARSE_STRIDE * MAX_ROLL_STEPS) is None:
        return None
    costs = np.empty((len(nodes), len(more)))
    rest = np.arange(len(nodes)) % COARSE_STRIDE != 0
    costs[~rest], costs[rest] = few, _roll_costs(model, candidate, nodes[rest], more, settings)
    way_through = _cheapest_sequence(costs, MAX_ROLL_STEPS)
    if way_through is None:
        return None
    u = tool_path.parameters[nodes]
    return u, candidate.roll(u) + ROLL_STEP * more[way_through]


def _roll_steps(joints: Array, arm: Arm) -> NDArray[np.int64]:
    """Return by how many turns (m,) the tool could be rolled further at some of the configurations (k, 6)."""
    first = int(np.floor((joints[:, 5].min() - arm.limits.upper[5]) / ROLL_STEP))
    last = int(np.ceil((joints[:, 5].max() - arm.limits.lower[5]) / ROLL_STEP))
    return np.arange(first, last + 1)


def _roll_costs(
    model: CollisionModel, candidate: Candidate, nodes: NDArray[np.int64], more: NDArray[np.int64],
    settings: MotionSettings,
) -> Array:  # fmt: skip
    """Return what each of `more` turns (m,) costs at nodes (k,) of the route: (k, m), infinite where it cannot be."""
    joints = candidate.joints[nodes]
    clear = _clearances(model, candidate, joints)[:, more % ROLL_COUNT]
    rolled = joints[:, 5, None] - ROLL_STEP * more
    lower, upper = model.arm.limits.lower[5], model.arm.limits.upper[5]
    free = (rolled >= lower) & (rolled <= upper) & (clear >= settings.clearance_min + SMOOTHING_CLEARANCE)
    costs = np.where(free, CLEARANCE_WEIGHT * np.maximum(SUFFICIENT_CLEARANCE - clear, 0.0), np.inf)
    if model.scene.carried is not None:
        costs[np.ix_(nodes == 0, more != 0)] = np.inf  # it is held as the candidate's own roll takes it
    return costs


def _clearances(model: CollisionModel, candidate: Candidate, joints: Array) -> Array:
    """Measure the clearance (k, ANGLES) [m] at configurations (k, 6) with the tool rolled further."""
    load = grasped_load(model, candidate.joints[0])
    every = np.repeat(joints[:, None], ROLL_COUNT, axis=1)
    every[:, :, 5] -= ROLL_STEP * np.arange(ROLL_COUNT)
    rows = model.clearances(every.reshape(-1, 6), load=load)
    return np.array([row.distance for row in rows]).reshape(len(joints), ROLL_COUNT)


def _cheapest_sequence(costs: Array, steps: int) -> NDArray[np.int64] | None:
    """Return the column at each row (k,) of the cheapest way through a grid of costs (k, m), or None without one."""
    count = costs.shape[1]
    total, came = costs[0], []
    for row in costs[1:]:
        padded = np.pad(total, steps, constant_values=np.inf)
        trials = np.stack([padded[k : k + count] + (k - steps) ** 2 for k in range(2 * steps + 1)])
        came.append(np.arange(count) + trials.argmin(axis=0) - steps)
        total = trials.min(axis=0) + row
    if not np.isfinite(total.min()):
        return None
    chosen = [int(np.argmin(total))]
    for back in reversed(came):
        chosen.append(int(back[chosen[-1]]))
    return np.array(chosen[::-1])


def _smoothed(u: Array, angles: Array) -> BSpline[np.float64]:
    """Draw a smooth curve near angles (k,); a spline with these for coefficients does not overshoot."""
    smooth = gaussian_filter1d(angles, FILTER_WIDTH, mode="nearest")
    inner = np.interp(np.linspace(0, len(u) - 1, max(len(u) // 3, 2)), np.arange(len(u)), u)
    knots = np.concatenate([np.zeros(SPLINE_DEGREE), inner, np.ones(SPLINE_DEGREE)])
    knots[SPLINE_DEGREE], knots[-SPLINE_DEGREE - 1] = 0.0, 1.0
    greville = np.convolve(knots[1:-1], np.full(SPLINE_DEGREE, 1 / SPLINE_DEGREE), mode="valid")
    return BSpline(knots, np.interp(greville, u, smooth), SPLINE_DEGREE)
