"""How much of the hand's way and turn the next motion tries, and why that is not all of it."""

from __future__ import annotations

from typing import Final

from teachpath.motion.execution.teleop_goal import STAYS_SHORT, TURNS_LESS

MIN_SHARE: Final = 0.02  # of the way to the target that is tried at least
MIN_TURN_SHARE: Final = 0.1  # of the hand's turn; below it none is tried
BACKOFF_FACTOR: Final = 0.5  # on the share that is tried, after something was too near
GROWTH_FACTOR: Final = 1.5  # on what was reduced, after a motion that passed its checks


class TriedShares:
    """Shares of the hand's way and turn: less after a motion that failed its checks, more again after one that passed.

    Attributes:
        way: share of the way to the target.
        turn: share of the hand's turn.
        reason: why a share was reduced last, in words; it holds until both are whole again.
    """

    def __init__(self) -> None:
        self.way: float = 1.0
        self.turn: float = 1.0
        self.reason: str = ""

    @property
    def are_whole(self) -> bool:
        """Whether all of the hand's way and turn is tried."""
        return self.way >= 1.0 and self.turn >= 1.0

    def back_off(self, near: str, *, turns: bool) -> None:
        """Try less next time: less of the hand's turn first, and less of its way only when there is no turn.

        Args:
            near: what stood in the way, in words.
            turns: whether the motion turned the tool.
        """
        if turns:
            share = BACKOFF_FACTOR * self.turn
            self.turn = share if share >= MIN_TURN_SHARE else 0.0
        else:
            self._shorten()
        self.reason = f"{near}, {TURNS_LESS if turns else STAYS_SHORT}"

    def shorten(self, reason: str) -> None:
        """Try less of the way next time, for a reason in words; an empty one leaves that which is said."""
        self._shorten()
        self.reason = reason or self.reason

    def grow(self) -> None:
        """Try more again."""
        self.way = min(GROWTH_FACTOR * self.way, 1.0)
        self.turn = min(max(GROWTH_FACTOR * self.turn, MIN_TURN_SHARE), 1.0)
        if self.are_whole:
            self.reason = ""

    def _shorten(self) -> None:
        self.way = max(BACKOFF_FACTOR * self.way, MIN_SHARE)
