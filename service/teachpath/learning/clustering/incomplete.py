"""Incomplete demonstrations: those that follow the first part of the others and stop before the goal."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teachpath.learning.clustering.dendrogram import Labels
from teachpath.learning.resampling import arc_lengths
from teachpath.lengths import describe_length
from teachpath.records import Array

MAX_SHARE = 0.95  # of the path of the complete ones; behind it the goal's own scatter hides what is missing
MIN_COMPLETE = 2  # demonstrations that follow the same first part and go on
MAX_OFFSET = 0.075  # share of the path length, of the mean distance from the first part of a complete one
END_WINDOW = 0.1  # share of a path around the expected place, in which the place of the stop is looked for


@dataclass(frozen=True, slots=True)
class Stop:
    """Where an incomplete demonstration stops.

    Attributes:
        share: of the path of the complete ones that it follows.
        missing: length of the rest of their path [m].
        follows: number of the complete demonstration whose first part is nearest.
    """

    share: float
    missing: float
    follows: int


def find_incomplete(paths: Array, groups: Labels, length: float) -> dict[int, Stop]:
    """Find demonstrations that alone end where they end, on the path of at least two that end together farther on.

    Args:
        paths: (m, n, 3) [m] at equal arc length.
        groups: (m,) labels of demonstrations with the same ends, see `ends.end_groups`.
        length: of a typical path [m].

    Returns:
        number of each incomplete demonstration -> where it stops.
    """
    sizes = np.bincount(groups)
    if sizes.max() < MIN_COMPLETE or sizes[1:].min() > 1:
        return {}
    lengths = np.array([arc_lengths(path)[-1] for path in paths])
    complete = np.flatnonzero(sizes[groups] >= MIN_COMPLETE)
    found = {}
    for i in np.flatnonzero(sizes[groups] == 1):
        longer = complete[lengths[i] < MAX_SHARE * lengths[complete]]
        shares, offsets = _first_parts(paths[i], lengths[i], paths[longer], lengths[longer])
        fits = (shares <= MAX_SHARE) & (offsets <= MAX_OFFSET * length)
        by_group = np.bincount(groups[longer][fits], minlength=1)
        if by_group.max() >= MIN_COMPLETE:
            same = fits & (groups[longer] == by_group.argmax())
            missing = float(np.median(((1 - shares) * lengths[longer])[same]))
            nearest = longer[same][np.argmin(offsets[same])]
            found[int(i)] = Stop(float(np.median(shares[same])), missing, int(nearest))
    return found


def describe(stop: Stop) -> str:
    """Say where a demonstration stops and how much is missing."""
    return f"is incomplete: it stops at {stop.share:.0%} of the way, {describe_length(stop.missing)} before its end"


def _first_parts(path: Array, length: float, others: Array, lengths: Array) -> tuple[Array, Array]:
    """Return at which share of each other path a path stops, and its mean distance [m] from the part before."""
    count = len(path)
    stations = np.arange(count)
    shares, offsets = np.ones(len(others)), np.full(len(others), np.inf)
    for k, (other, whole) in enumerate(zip(others, lengths, strict=True)):
        apart = np.linalg.norm(other - path[-1], axis=1)
        apart[np.abs(stations / (count - 1) - length / whole) > END_WINDOW] = np.inf
        stop = int(np.argmin(apart))
        if stop > 0:
            at = np.linspace(0.0, stop, count)
            part = np.column_stack([np.interp(at, stations, other[:, axis]) for axis in range(3)])
            shares[k] = stop / (count - 1)
            offsets[k] = float(np.linalg.norm(part - path, axis=1).mean())
    return shares, offsets
