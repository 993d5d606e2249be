"""Input validation: refuses demonstrations that no path can be learned from."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from teachpath.errors import LearningFailed
from teachpath.lengths import describe_lengths
from teachpath.records import Trajectory

MIN_DISTINCT_POINTS = 5
MIN_EXTENT = 1e-3  # m, extent below which a hand has not moved


def set_aside_motionless(demonstrations: Mapping[str, Trajectory]) -> tuple[dict[str, Trajectory], list[str]]:
    """Return the demonstrations that move, and a sentence about each of the others; all, if none moves."""
    moving = {name: each for name, each in demonstrations.items() if not _is_motionless(each)}
    if not moving:
        return dict(demonstrations), []
    still = [name for name in demonstrations if name not in moving]
    return moving, [f"demonstration {name} {_stillness(demonstrations[name])} and is left out" for name in still]


def validate(demonstrations: Mapping[str, Trajectory]) -> None:
    """Refuse a set of demonstrations that no path can be learned from.

    Raises:
        LearningFailed: the set is empty, or a demonstration is misshapen, not finite, runs backwards in time, has
            fewer than five distinct points or does not move; the error carries its id.
    """
    if not demonstrations:
        raise LearningFailed("there is no demonstration to learn from; record at least one")
    for name, trajectory in demonstrations.items():
        fault = _fault(trajectory)
        if fault:
            raise LearningFailed(f"demonstration {name} {fault}; leave it out or record it again", name)


def _fault(trajectory: Trajectory) -> str:
    times, positions = trajectory.times, trajectory.positions
    if positions.ndim != 2 or positions.shape[1] != 3 or times.shape != positions.shape[:1]:
        return f"has positions of shape {positions.shape} for times of shape {times.shape}, not (n, 3) and (n,)"
    finite = np.isfinite(positions).all(axis=1) & np.isfinite(times)
    if not finite.all():
        return f"is not finite at sample {int(np.argmin(finite))} of {len(times)}"
    backwards = np.diff(times) <= 0
    if backwards.any():
        return f"does not go forward in time at sample {int(np.argmax(backwards)) + 1}"
    distinct = len(np.unique(positions, axis=0))
    if distinct < MIN_DISTINCT_POINTS:
        return f"has {distinct} distinct points, needs {MIN_DISTINCT_POINTS}"
    return _stillness(trajectory) if _extent(trajectory) < MIN_EXTENT else ""


def _is_motionless(trajectory: Trajectory) -> bool:
    positions = trajectory.positions
    sound = (
        positions.ndim == 2 and positions.shape[1] == 3 and len(positions) > 0 and bool(np.isfinite(positions).all())
    )
    return sound and _extent(trajectory) < MIN_EXTENT


def _extent(trajectory: Trajectory) -> float:
    return float(np.linalg.norm(np.ptp(trajectory.positions, axis=0)))


def _stillness(trajectory: Trajectory) -> str:
    extent = _extent(trajectory)
    if extent == 0:
        return "does not move"
    told, needed = describe_lengths(extent, MIN_EXTENT)
    return f"moves only {told}, needs {needed}"
