"""Versions of an edited path, and the difference between two of them."""

from __future__ import annotations

from dataclasses import dataclass

MAIN_BRANCH = "main"  # the branch that a learned path begins on


@dataclass(frozen=True, slots=True)
class Version:
    """One saved version of a path; the curve is the `LearnedPath` with the same number.

    Attributes:
        path: id of the learned path.
        number: from 1, in the order of saving, over all branches of a path.
        parent: number of the version that was edited; None for the learned path.
        branch: line of versions that this version continues.
        name: what somebody called it; empty: nothing.
        author: who edited it; empty: not said.
        note: why, or how it was made; empty: not said.
        created_ns: when it was saved [ns since the Unix epoch].
    """

    path: str
    number: int
    parent: int | None
    branch: str
    name: str
    author: str
    note: str
    created_ns: int


@dataclass(frozen=True, slots=True)
class ControlPointChange:
    """One control point that differs between two curves.

    Attributes:
        number: in the second curve, from 1.
        distance: between both positions [m].
        weights: before and after.
    """

    number: int
    distance: float
    weights: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Difference:
    """The difference between two curves.

    Attributes:
        largest: Hausdorff distance of the curves [m].
        mean: distance of the points of each curve from the other curve, averaged over both curves [m].
        s: arc length on the second curve at the largest distance [m].
        moved: control points that differ, on the second curve's knots; None when they cannot be matched.
        sentence: the difference in words.
    """

    largest: float
    mean: float
    s: float
    moved: tuple[ControlPointChange, ...] | None
    sentence: str
