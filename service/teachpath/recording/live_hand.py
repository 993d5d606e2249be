"""A hand as it is seen now: what the preview draws of a running recording."""

from __future__ import annotations

from dataclasses import dataclass

from teachpath.recording.demonstration import Pose
from teachpath.records import Phase, Shape, Vector


@dataclass(frozen=True, slots=True)
class Hand:
    """One hand that is being recorded."""

    tracker: str
    received: int  # samples; while it does not rise the hand is silent
    take: int  # 1, 2, ... counting every one that was begun
    phase: Phase
    closed: bool
    position: Vector  # [m, world]
    thing: Shape | None  # what it is there to carry, at its start
    carried: Pose | None  # where that is, while it is in the hand

    @property
    def holds(self) -> bool:
        """Whether the object is in the hand."""
        return self.phase in (Phase.GRASP, Phase.TRANSPORT, Phase.RELEASE)
