"""What every motion that was read from a file must keep, whatever its format; says which unit is likely wrong."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from teachpath.errors import UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import UNITS, Booleans, OptionNeeded, Track
from teachpath.io.wire import MAX_COORDINATE
from teachpath.records import Array
from teachpath_proto.sample_rules import UNIT_TOLERANCE

LARGEST_SPAN = 10.0  # [m] of a motion in one axis; an arm reaches 1 m
LIKELY_SPAN = (0.02, 5.0)  # [m] of a motion, if another unit were right


def checked(track: Track, where: str, limits: ImportSettings) -> Track:
    """Return a track whose untracked readings are told: blank cells, places at 0, 0, 0, and those that it says.

    Raises:
        UnusableRecording: too few readings, an implausible unit, or quaternions of no unit length.
    """
    count = len(track.positions)
    if count < 2:
        raise UnusableRecording(f"{where}: {count} samples are too few for a motion")
    tracked = _tracked(track)
    if np.count_nonzero(tracked) < 2:
        raise UnusableRecording(f"{where}: {np.count_nonzero(tracked)} of its {count} samples are tracked; too few")
    _check_clock(track, where, limits)
    _check_size(track.positions[tracked], where)
    if track.orientations is not None:
        _check_quaternions(track.orientations, tracked, where)
    return replace(track, tracked=None if tracked.all() else tracked)


def _tracked(track: Track) -> Booleans:
    tracked = np.isfinite(track.positions).all(axis=1)
    if track.tracked is not None:
        tracked &= track.tracked
    if track.orientations is not None:
        tracked &= np.isfinite(track.orientations).all(axis=1)
        tracked &= np.any(track.orientations != 0.0, axis=1)
    lost = np.all(track.positions == 0.0, axis=1)  # many programs write zeros where they see nothing
    if np.count_nonzero(tracked & ~lost) >= 2:
        tracked &= ~lost
    return np.asarray(tracked)


def _check_clock(track: Track, where: str, limits: ImportSettings) -> None:
    span = (int(track.stamps_ns.max()) - int(track.stamps_ns.min())) * 1e-9
    if span > limits.max_duration:
        raise OptionNeeded(
            f"{where}: it lasts {span:g} s, limit {limits.max_duration:g} (imports.max_duration), if t is in the right "
            "unit",
            "time",
        )
    steps = np.diff(track.stamps_ns)
    back = int(np.count_nonzero(steps < 0))
    if back > len(steps) // 2:
        raise UnusableRecording(f"{where}: t runs backwards at {back} of {len(steps)} steps; sort by t")
    if not np.any(steps):
        raise OptionNeeded(f"{where}: t never changes, so that it is no clock", "columns", "t=...")


def _check_size(positions: Array, where: str) -> None:
    farthest, span = float(np.abs(positions).max()), float(np.ptp(positions, axis=0).max())
    if farthest <= MAX_COORDINATE and span <= LARGEST_SPAN:
        return
    low, high = LIKELY_SPAN
    likely = [
        f"{unit} ({span * factor:.2g} m)"
        for unit, factor in UNITS.items()
        if low <= span * factor <= high and farthest * factor <= MAX_COORDINATE
    ]
    what = f"the motion spans {span:.3g} m" if span > LARGEST_SPAN else f"a position is {farthest:.3g} m away"
    limit = LARGEST_SPAN if span > LARGEST_SPAN else MAX_COORDINATE
    raise OptionNeeded(f"{where}: {what}, limit {limit:g}", "units", *likely)


def _check_quaternions(orientations: Array, tracked: Booleans, where: str) -> None:
    with np.errstate(over="ignore"):  # a damaged one may be as long as numbers go
        norms = np.where(tracked, np.linalg.norm(np.where(tracked[:, None], orientations, 0.0), axis=1), 1.0)
    worst = int(np.argmax(np.abs(norms - 1.0)))
    if not math.isclose(float(norms[worst]), 1.0, abs_tol=UNIT_TOLERANCE):
        raise UnusableRecording(
            f"{where}: the quaternion of sample {worst} has length {norms[worst]:.3g}, not 1; are these its columns?"
        )
