"""The clutch of a live hand: the arm follows only while it is pressed, and only after it was open once."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Final

from teachpath.errors import UnusableSample
from teachpath.io.bus import Bus
from teachpath.io.wire import decode_sample
from teachpath.records import Sample
from teachpath_proto.keys import Keys

CLUTCH_BUTTON: Final = 4  # button that is pressed while the arm mirrors the hand
RELEASE_FIRST_HINT: Final = "let the clutch go, and press it again to move the arm"
PRESS_HINT: Final = "press the clutch (button bit 2) to move the arm"


class Clutch:
    """Follows a button that may be lost at any moment.

    Attributes:
        engaged: whether the arm follows.
        hold_requested: whether `hold` was asked for and not taken back.
        reason: why the arm does not follow.
    """

    def __init__(self) -> None:
        self.engaged = self.hold_requested = False
        self.reason = PRESS_HINT
        self._released = False  # the button was up since

    def update(self, pressed: bool) -> bool:
        """Take whether the button is down; return whether the clutch has just closed."""
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
        """Open it, whatever the button does: it must be up once before the arm follows again."""
        self.engaged, self._released, self.reason = False, False, reason

    def hold(self) -> None:
        """Open it until `resume`."""
        self.hold_requested = True
        self.disengage("held")

    def resume(self) -> None:
        """Let it be pressed again."""
        self.hold_requested, self.reason = False, PRESS_HINT


class RemoteClutch:
    """Another tracker whose button is the clutch: somebody who looks on, while the hand has no button.

    Attributes:
        pressed: whether the button was down in the newest tracked sample.
        last_seen_ns: when that came [ns of the clock].
    """

    def __init__(self, bus: Bus, keys: Keys, tracker: str, clock: Callable[[], int]) -> None:
        self.pressed, self.last_seen_ns = False, 0
        self._tracker = tracker
        self._newest: deque[tuple[int, bytes]] = deque(maxlen=1)
        self._handle = bus.subscribe(keys.samples(tracker), lambda _, payload: self._newest.append((clock(), payload)))

    def poll(self) -> None:
        """Read what came."""
        if not self._newest:
            return
        when, payload = self._newest.pop()
        sample = decode_tracked(self._tracker, payload, when)
        if sample is not None:
            self.pressed, self.last_seen_ns = bool(sample.buttons & CLUTCH_BUTTON), when

    def close(self) -> None:
        """Stop listening."""
        self._handle.close()


def decode_tracked(tracker: str, payload: bytes, when: int) -> Sample | None:
    """Return a sample, or None when it cannot be used or the hand was not tracked in it."""
    try:
        sample = decode_sample(tracker, payload, when)
    except UnusableSample:
        return None
    return sample if sample.tracked else None
