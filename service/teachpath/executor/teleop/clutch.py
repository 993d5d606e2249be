"""The clutch of a live hand: the arm follows only while it is pressed, and only after it was released once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from teachpath.errors import UnusableSample
from teachpath.executor.teleop.tracker_input import TrackerInput
from teachpath.io.bus import Bus
from teachpath.io.wire import decode_sample
from teachpath.records import Sample
from teachpath_proto.keys import Keys

CLUTCH_BUTTON: Final = 4  # mask of the button in a sample
RELEASE_FIRST_HINT: Final = "let the clutch go, and press it again to move the arm"
PRESS_HINT: Final = "press the clutch (button bit 2) to move the arm"


class Clutch:
    """Follows a button that may be lost at any moment.

    Attributes:
        engaged: whether the arm follows.
        hold_requested: whether `hold` was called and not taken back.
        reason: why the arm does not follow, in words.
    """

    def __init__(self) -> None:
        self.engaged = False
        self.hold_requested = False
        self.reason = PRESS_HINT
        self._released = False  # whether the button was up since the clutch was last engaged

    def update(self, pressed: bool) -> bool:
        """Take whether the button is pressed; return whether the clutch has just engaged."""
        if not pressed:
            if self.engaged:
                self.disengage(PRESS_HINT)
            self._released = True
            self.reason = PRESS_HINT if self.reason == RELEASE_FIRST_HINT else self.reason
        elif self._released and not self.hold_requested:
            self.engaged, self._released, self.reason = True, False, ""
            return True
        elif not self.engaged and not self.hold_requested:
            self.reason = RELEASE_FIRST_HINT
        return False

    def disengage(self, reason: str) -> None:
        """Let the arm rest, whatever the button does: it must be released before the arm follows again."""
        self.engaged, self._released, self.reason = False, False, reason

    def hold(self) -> None:
        """Disengage until `resume`."""
        self.hold_requested = True
        self.disengage("held")

    def resume(self) -> None:
        """Let the clutch be pressed again."""
        self.hold_requested, self.reason = False, PRESS_HINT


class RemoteClutch:
    """The button of another tracker, which somebody who watches presses while the hand has none.

    Args:
        session: whose samples count; empty: those of the session that sends first.
        clock: returns monotonic nanoseconds.

    Attributes:
        pressed: whether the button was pressed in the newest tracked sample.
        last_seen_ns: when that sample came [ns of the clock].
    """

    def __init__(self, bus: Bus, keys: Keys, tracker: str, session: str, clock: Callable[[], int]) -> None:
        self.pressed = False
        self.last_seen_ns = 0
        self._tracker = tracker
        self._input = TrackerInput(bus, keys, tracker, session, clock)

    def poll(self) -> None:
        """Read the newest sample."""
        if (newest := self._input.pop()) is None:
            return
        came_ns, payload = newest
        sample = decode_tracked(self._tracker, payload, came_ns)
        if sample is not None:
            self.pressed = bool(sample.buttons & CLUTCH_BUTTON)
            self.last_seen_ns = came_ns

    def close(self) -> None:
        """Stop listening."""
        self._input.close()


def decode_tracked(tracker: str, payload: bytes, came_ns: int) -> Sample | None:
    """Return a sample, or None when it cannot be used or the hand was not tracked in it."""
    try:
        sample = decode_sample(tracker, payload, came_ns)
    except UnusableSample:
        return None
    return sample if sample.tracked else None
