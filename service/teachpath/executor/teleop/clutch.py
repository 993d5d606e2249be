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

CLUTCH: Final = 4  # button that is pressed while the arm mirrors the hand
AGAIN: Final = "let the clutch go, and press it again to move the arm"
WAITING: Final = "press the clutch (button bit 2) to move the arm"


class Clutch:
    """Follows a button that may be lost at any moment.

    Attributes:
        pressed: whether the arm follows.
        stopped: whether `hold` was asked for and not taken back.
        why: the arm does not follow, in words.
    """

    def __init__(self) -> None:
        self.pressed = self.stopped = False
        self.why = WAITING
        self._fresh = False  # the button was up since

    def hear(self, down: bool) -> bool:
        """Take whether the button is down; return whether the clutch has just closed."""
        if not down:
            if self.pressed:
                self.open(WAITING)
            self._fresh = True
            self.why = WAITING if self.why == AGAIN else self.why
        elif self._fresh and not self.stopped:
            self.pressed, self._fresh, self.why = True, False, ""
            return True
        elif not self.pressed and not self.stopped:
            self.why = AGAIN
        return False

    def open(self, why: str) -> None:
        """Open it, whatever the button does: it must be up once before the arm follows again."""
        self.pressed, self._fresh, self.why = False, False, why

    def hold(self) -> None:
        """Open it until `resume`."""
        self.stopped = True
        self.open("held")

    def resume(self) -> None:
        """Let it be pressed again."""
        self.stopped, self.why = False, WAITING


class RemoteClutch:
    """Another tracker whose button is the clutch: somebody who looks on, while the hand has no button.

    Attributes:
        down: whether the button was down in the newest tracked sample.
        seen: when that came [ns of the clock].
    """

    def __init__(self, bus: Bus, keys: Keys, tracker: str, clock: Callable[[], int]) -> None:
        self.down, self.seen = False, 0
        self._tracker = tracker
        self._came: deque[tuple[int, bytes]] = deque(maxlen=1)
        self._handle = bus.subscribe(keys.samples(tracker), lambda _, payload: self._came.append((clock(), payload)))

    def listen(self) -> None:
        """Read what came."""
        if not self._came:
            return
        when, payload = self._came.pop()
        sample = tracked(self._tracker, payload, when)
        if sample is not None:
            self.down, self.seen = bool(sample.buttons & CLUTCH), when

    def close(self) -> None:
        """Stop listening."""
        self._handle.close()


def tracked(tracker: str, payload: bytes, when: int) -> Sample | None:
    """Return a sample, or None when it cannot be used or the hand was not tracked in it."""
    try:
        sample = decode_sample(tracker, payload, when)
    except UnusableSample:
        return None
    return sample if sample.tracked else None
