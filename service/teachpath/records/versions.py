"""What is kept of an edited path: its versions, and how two of them differ."""

from __future__ import annotations

from dataclasses import dataclass

MAIN_BRANCH = "main"  # the branch that a learned path begins on


@dataclass(frozen=True, slots=True)
class Version:
    """Who saved what when; the curve is the learned path of the same number.

    Attributes:
        path: id of the learned path.
        number: from 1, in the order in which the versions of a path were saved, over all branches.
        parent: number of the version that was edited; None for the one that was learned.
        branch: line of versions that this one continues.
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
    """One control point that differs.

    Attributes:
        number: in the second curve, from 1.
        distance: by which it moved [m].
        weights: before and after.
    """

    number: int
    distance: float
    weights: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Difference:
    """How far the second of two curves lies from the first.

    Attributes:
        largest: distance of a point of one from the other, the larger of both ways (Hausdorff) [m].
        mean: over both ways, along the arc lengths [m].
        s: arc length on the second curve where it is farthest from the first [m].
        moved: control points that differ, on the second curve's knots; None when they have no counterparts.
        sentence: all of it in words.
    """

    largest: float
    mean: float
    s: float
    moved: tuple[ControlPointChange, ...] | None
    sentence: str
