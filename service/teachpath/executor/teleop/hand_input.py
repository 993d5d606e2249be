"""The samples of a live hand and the state of its clutch, as they come from the bus."""

from __future__ import annotations

from collections.abc import Callable

from teachpath.executor.teleop.clutch import CLUTCH_BUTTON, RemoteClutch, decode_tracked
from teachpath.executor.teleop.tracker_input import TrackerInput
from teachpath.io.bus import Bus
from teachpath.records import Sample, TeleopRequest
from teachpath_proto.keys import Keys, anonymous_refusal


class HandInput:
    """Keeps the newest sample of a tracker, and notices when the hand or its clutch is lost.

    Args:
        request: names the tracker, whose button is its clutch, and the sessions that both belong to.
        silence: without a tracked sample after which hand or clutch count as lost [s].
        clock: returns monotonic nanoseconds.
    """

    def __init__(
        self, bus: Bus, keys: Keys, request: TeleopRequest, *, silence: float, clock: Callable[[], int]
    ) -> None:
        self._request = request
        self._silence_ns = silence * 1e9
        self._clock = clock
        self._last_seen_ns = 0  # of the clock, when the newest tracked sample came
        self._remote_clutch = (
            RemoteClutch(bus, keys, request.clutch, request.clutch_session, clock) if request.clutch else None
        )
        self._input = TrackerInput(bus, keys, request.tracker, request.tracker_session, clock)

    def poll(self) -> tuple[int, Sample] | None:
        """Return the newest sample in which the hand was tracked, and when it came; None when no other has come."""
        if self._remote_clutch is not None:
            self._remote_clutch.poll()
        if (newest := self._input.pop()) is None:
            return None
        came_ns, payload = newest
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
            name = self._request.tracker
            if self._input.has_stranger(now):
                return f"{name} was lost, and another session sends as {name}; stop, and begin again to follow that one"
            if self._input.has_anonymous(now):
                return anonymous_refusal(name)
            return "the hand was lost; let the clutch go and press it again"
        if self._remote_clutch is not None and now - self._remote_clutch.last_seen_ns > self._silence_ns:
            return f"nothing was heard of {self._request.clutch}, who presses the clutch; press it again"
        return ""

    def intrusion(self, now: int) -> str:
        """Return that another session sends under the tracker's name at `now` [ns of the clock], or an empty string."""
        if not self._input.has_stranger(now):
            return anonymous_refusal(self._request.tracker) if self._input.has_anonymous(now) else ""
        return f"another session sends as {self._request.tracker} too, which the arm does not follow"

    def close(self) -> None:
        """Stop listening to the tracker, and to the one whose button is the clutch."""
        self._input.close()
        if self._remote_clutch is not None:
            self._remote_clutch.close()
