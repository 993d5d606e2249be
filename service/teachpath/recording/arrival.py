"""How a sample came: in order, late, twice, or in conflict with those before."""

from __future__ import annotations

from enum import Enum, auto
from functools import cached_property


class Arrival(Enum):
    """How a sample came."""

    IN_ORDER = auto()  # newer than all before
    REORDERED = auto()  # after newer ones; its number was missing, and its time fits between its neighbours'
    LATE = auto()  # likewise, but after its interval had ended
    DUPLICATED = auto()  # for a second time, unchanged
    CONFLICTING = auto()  # with a number that is taken, or with a time that contradicts its number

    @cached_property  # asked for every sample; it costs a microsecond to look members up
    def belongs(self) -> bool:
        """Whether the sample has a place of its own in the current interval."""
        return self in (Arrival.IN_ORDER, Arrival.REORDERED)
