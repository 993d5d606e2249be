"""A gesture that commands the recorder: a fist, held still and away from the object, then opened.

A fist held for `fist_time` pauses or resumes, as the pedal does; one held three times as long discards the last
demonstration; one held more than six times as long is a resting hand and commands nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from teachpath.recording.phases import hand_closure
from teachpath.recording.sample_runs import Grip, SampleBlock, SampleRun
from teachpath.recording.settings import RecordingSettings
from teachpath.records import FistCommand, Sample, Vector

DISCARD_FACTOR = 3  # times `fist_time`, from which a fist discards
REST_FACTOR = 6  # times `fist_time`, beyond which a fist is a resting hand


class FistGesture:
    """Follows the fists of one glove; a device without flexions has none.

    Args:
        carried: start of the object's centre [m, world]; None: a closed hand is a grasp anywhere, never a command.
            Set it anew when the object lies elsewhere.
    """

    def __init__(self, settings: RecordingSettings, carried: Vector | None) -> None:
        self._settings = settings
        self.carried: Vector | None = carried
        self._began: int | None = None  # device clock [ns]
        self._place: Vector = (0.0, 0.0, 0.0)
        self._opened: int | None = None  # device clock [ns] of its opening, while that may still be a flicker
        self._is_void = False  # this fist commands nothing; the hand must open first
        self._held_ns = 0

    @property
    def pending_command(self) -> FistCommand | None:
        """What the fist would command if it opened now."""
        if self._began is None or self._is_void or not self._settings.fist_time:
            return None
        factor = self._held_ns * 1e-9 / self._settings.fist_time
        if factor < 1 or factor > REST_FACTOR:
            return None
        return FistCommand.DISCARD if factor >= DISCARD_FACTOR else FistCommand.TOGGLE

    def push(self, sample: Sample, position: Vector, *, carrying: bool) -> FistCommand | None:
        """Add the next sample, newer than all before, and its hand position [m, world]; return the command it ends."""
        if self.carried is None or not sample.flexions or not self._settings.fist_time:
            return None
        closure = hand_closure(sample)
        if self._began is None:
            if closure > self._settings.fist_at:
                self._begin(sample, position, carrying)
            return None
        if sample.tracked and math.dist(position, self._place) > self._settings.fist_motion:
            self._is_void = True
        if closure >= self._settings.open_at:
            self._opened = None
            self._held_ns = sample.device_ns - self._began
            return None
        return self._open(sample)

    def is_idle_in(self, run: SampleRun) -> bool:
        """Tell whether the samples of a run that comes next neither begin nor end a fist."""
        if self.carried is None or not run.has_flexions or not self._settings.fist_time:
            return True
        return run.grip < Grip.FIST if self._began is None else run.grip > Grip.OPEN

    def observe_run(
        self, block: SampleBlock, run: SampleRun, places: tuple[int, int], to_world: Callable[[Vector], Vector]
    ) -> None:
        """Add samples of a run that neither begin nor end a fist, from the first place to before the second."""
        if self._began is None or self.carried is None or not (run.has_flexions and self._settings.fist_time):
            return
        begin, end = places
        for at in range(begin, end):
            if self._is_void:
                break
            place = to_world(block.position(at))
            self._is_void = block.tracked[at] and math.dist(place, self._place) > self._settings.fist_motion
        self._opened = None
        self._held_ns = block.device_ns[end - 1] - self._began

    def _begin(self, sample: Sample, position: Vector, carrying: bool) -> None:
        assert self.carried is not None
        self._began = sample.device_ns
        self._opened = None
        self._place = position
        self._held_ns = 0
        near = math.dist(position, self.carried) < self._settings.fist_distance
        self._is_void = carrying or near or not sample.tracked

    def _open(self, sample: Sample) -> FistCommand | None:
        if self._opened is None:
            self._opened = sample.device_ns
        if sample.device_ns - self._opened < self._settings.release_time * 1e9:
            return None
        command = self.pending_command
        self._began = None
        return command
