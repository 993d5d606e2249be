"""The samples of a live hand and the state of its clutch, as they come from the bus."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from teachpath.executor.teleop.clutch import CLUTCH_BUTTON, RemoteClutch, decode_tracked
from teachpath.io.bus import Bus
from teachpath.records import Sample, TeleopRequest
from teachpath_proto.keys import Keys


class HandInput:
    """Keeps the newest sample of a tracker, and notices when the hand or its clutch is lost.

    Args:
        request: names the tracker, and whose button is its clutch.
        silence: without a tracked sample after which hand or clutch count as lost [s].
        clock: returns monotonic nanoseconds.
    """

    def __init__(
        self, bus: Bus, keys: Keys, request: TeleopRequest, *, silence: float, clock: Callable[[], int]
    ) -> None:
        self._request = request
        self._silence_ns = silence * 1e9
        self._clock = clock
        self._newest: deque[tuple[int, bytes]] = deque(maxlen=1)
        self._last_seen_ns = 0  # of the clock, when the newest tracked sample came
        self._remote_clutch = RemoteClutch(bus, keys, request.clutch, clock) if request.clutch else None
        self._handle = bus.subscribe(keys.samples(request.tracker), self._receive)

    def poll(self) -> tuple[int, Sample] | None:
        """Return the newest sample in which the hand was tracked, and when it came; None when no other has come."""
        if self._remote_clutch is not None:
            self._remote_clutch.poll()
        if not self._newest:
            return None
        came_ns, payload = self._newest.pop()
        sample = decode_tracked(self._request.tracker, payload, came_ns)
        if sample is None:
            return None
        self._last_seen_ns = came_ns
        return came_ns, sample

    def is_clutch_pressed(self, sample: Sample) -> bool:
        """Tell whether the clutch is pressed: the button of the sample, or that of the other tracker."""
        if self._remote_clutch is not None:
            return self._remote_clutch.pressed
        return bool(sample.buttons & CLUTCH_BUTTON)

    @property
    def is_remote_clutch_released(self) -> bool:
        """Whether another tracker's button is the clutch, and it is not pressed."""
        return self._remote_clutch is not None and not self._remote_clutch.pressed

    def loss(self, now: int) -> str:
        """Return why the arm must not follow the hand at `now` [ns of the clock], or an empty string."""
        if now - self._last_seen_ns > self._silence_ns:
            return "the hand was lost; let the clutch go and press it again"
        if self._remote_clutch is not None and now - self._remote_clutch.last_seen_ns > self._silence_ns:
            return f"nothing was heard of {self._request.clutch}, who presses the clutch; press it again"
        return ""

    def close(self) -> None:
        """Stop listening to the tracker, and to the one whose button is the clutch."""
        self._handle.close()
        if self._remote_clutch is not None:
            self._remote_clutch.close()

    def _receive(self, _: str, payload: bytes) -> None:
        self._newest.append((self._clock(), payload))
