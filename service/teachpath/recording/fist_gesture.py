"""A sign that the hand itself gives: a fist, held still and away from the object, then opened.

Held for `fist_time` it pauses or resumes, as the pedal does; held for three times as long it discards the last
demonstration; held for more than six times as long it is a resting hand and says nothing.
"""

from __future__ import annotations

import math

from teachpath.recording.phases import hand_closure
from teachpath.recording.settings import RecordingSettings
from teachpath.records import FistCommand, Sample, Vector

DISCARD_FACTOR, REST_FACTOR = 3, 6  # times `fist_time`


class FistGesture:
    """Follows one glove; a device without flexions gives no sign.

    Args:
        carried: start of the object's centre [m, world], or None: then a closed hand is a grasp anywhere, never a sign.
    """

    def __init__(self, settings: RecordingSettings, carried: Vector | None) -> None:
        self._settings, self._carried = settings, carried
        self._began: int | None = None  # device clock [ns]
        self._place: Vector = (0.0, 0.0, 0.0)
        self._opened: int | None = None  # when it opened, while that may still be a flicker
        self._spoilt = False  # this fist is no sign; the hand must open first
        self._held_ns = 0

    @property
    def pending_command(self) -> FistCommand | None:
        """What the fist would ask for if it opened now."""
        if self._began is None or self._spoilt or not self._settings.fist_time:
            return None
        turns = self._held_ns * 1e-9 / self._settings.fist_time
        if turns < 1 or turns > REST_FACTOR:
            return None
        return FistCommand.DISCARD if turns >= DISCARD_FACTOR else FistCommand.TOGGLE

    def push(self, sample: Sample, position: Vector, *, carrying: bool) -> FistCommand | None:
        """Take the next sample, newer than all before, and its hand position [m, world]; return the sign it ends."""
        if self._carried is None or not sample.flexions or not self._settings.fist_time:
            return None
        closure = hand_closure(sample)
        if self._began is None:
            if closure > self._settings.fist_at:
                self._begin(sample, position, carrying)
            return None
        if sample.tracked and math.dist(position, self._place) > self._settings.fist_motion:
            self._spoilt = True
        if closure >= self._settings.open_at:
            self._opened = None
            self._held_ns = sample.device_ns - self._began
            return None
        return self._open(sample)

    def _begin(self, sample: Sample, position: Vector, carrying: bool) -> None:
        assert self._carried is not None
        self._began, self._opened, self._place, self._held_ns = sample.device_ns, None, position, 0
        near = math.dist(position, self._carried) < self._settings.fist_distance
        self._spoilt = carrying or near or not sample.tracked

    def _open(self, sample: Sample) -> FistCommand | None:
        if self._opened is None:
            self._opened = sample.device_ns
        if sample.device_ns - self._opened < self._settings.release_time * 1e9:
            return None
        sign = self.pending_command
        self._began = None
        return sign
