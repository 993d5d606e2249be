"""Where an adapted path begins and ends."""

from __future__ import annotations

from dataclasses import dataclass

from teachpath.records import Array


@dataclass(frozen=True, eq=False)
class Target:
    """Where the object lies and where it is to go, in the world.

    Attributes:
        start: (3,) [m].
        goal: (3,) [m].
        start_orientation: (4,) unit quaternion w, x, y, z; None = as learned.
        goal_orientation: likewise.
    """

    start: Array
    goal: Array
    start_orientation: Array | None = None
    goal_orientation: Array | None = None
