"""The clutch of a live hand: the arm follows only while it is pressed, and only after it was released once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
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


@dataclass(frozen=True)
class _Pause:
    """Until when the arm goes on by itself [ns of a clock], and why it does not any more after that."""

    lapsed: str
    deadline_ns: int


class Clutch:
    """Follows a button that may be lost at any moment.

    Attributes:
        engaged: whether the arm follows.
        hold_requested: whether `hold` was called and not taken back.
        reason: why the arm does not follow, in words.
    """

    def __init__(self) -> None:
        self.engaged: bool = False
        self.hold_requested: bool = False
        self.reason: str = PRESS_HINT
        self._released = False  # whether the button was up since the clutch was last engaged
        self._pause: _Pause | None = None

    def update(self, pressed: bool) -> bool:
        """Take whether the button is pressed; return whether the clutch has just engaged."""
        if not pressed:
            if self.engaged or self.is_paused:
                self.disengage(PRESS_HINT)
            self._released = True
            self.reason = PRESS_HINT if self.reason.startswith(RELEASE_FIRST_HINT) else self.reason
        elif self._released and not self.hold_requested:
            self.engaged, self._released, self.reason = True, False, ""
            return True
        elif not (self.engaged or self.is_paused or self.hold_requested):
            self._ask_for_release()
        return False

    @property
    def awaits_press(self) -> bool:
        """Whether the arm does not follow for the one reason that the button is not pressed."""
        return not self.engaged and self.reason == PRESS_HINT

    @property
    def is_paused(self) -> bool:
        """Whether the arm goes on without another press when what was lost is back."""
        return self._pause is not None

    def pause(self, reason: str, lapsed: str, deadline_ns: int) -> None:
        """Let the arm rest until `go_on`; at the deadline [ns of a clock] the button has to be released first.

        Args:
            reason: why the arm rests, in words.
            lapsed: the same from the deadline on.
        """
        self.disengage(reason)
        self._pause = _Pause(lapsed, deadline_ns)

    def go_on(self) -> None:
        """Let the arm follow again after a pause."""
        self.disengage("")
        self.engaged = True

    def give_up_pause(self, now: int) -> None:
        """Let the button be released before the arm follows again, if the deadline has passed by `now` [ns]."""
        if self._pause is not None and now >= self._pause.deadline_ns:
            self.disengage(self._pause.lapsed)

    def disengage(self, reason: str) -> None:
        """Let the arm rest, whatever the button does: it must be released before the arm follows again."""
        self.engaged, self._released, self.reason, self._pause = False, False, reason, None

    def _ask_for_release(self) -> None:
        if not self.reason.startswith(RELEASE_FIRST_HINT):
            why, way_out, _ = self.reason.partition(";")
            self.reason = f"{RELEASE_FIRST_HINT}: {why}" if way_out else RELEASE_FIRST_HINT

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
        self.pressed: bool = False
        self.last_seen_ns: int = 0
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
