"""What the operator of a recording commands with the hand: by its pedal, or by a fist."""

from __future__ import annotations

from collections.abc import Callable

from teachpath.recording.fist_gesture import FistGesture
from teachpath.recording.phases import TOGGLE_BUTTON
from teachpath.recording.sample_runs import SampleBlock, SampleRun
from teachpath.recording.settings import RecordingSettings
from teachpath.records import FistCommand, Sample, Vector


class HandCommands:
    """Follows pedal and fists of one recording.

    Args:
        carried: start of the object's centre [m, world]; None: there is no object, and a fist commands nothing.

    Attributes:
        pedal_used: whether the pedal has been pressed.
    """

    def __init__(self, settings: RecordingSettings, carried: Vector | None) -> None:
        self._gesture = FistGesture(settings, carried)
        self._buttons = 0
        self._discard_requested = False
        self.pedal_used: bool = False

    @property
    def pending(self) -> FistCommand | None:
        """What the fist would command if it opened now."""
        return self._gesture.pending_command

    def push(self, sample: Sample, position: Vector, *, carrying: bool) -> bool:
        """Add the next sample, newer than all before; return whether it pauses or resumes the recording."""
        pressed = sample.buttons & TOGGLE_BUTTON and not self._buttons & TOGGLE_BUTTON
        self._buttons = sample.buttons
        command = self._gesture.push(sample, position, carrying=carrying)
        if command is FistCommand.DISCARD:
            self._discard_requested = True
        if pressed:
            self.pedal_used = True
        return bool(pressed) or command is FistCommand.TOGGLE

    def is_idle_in(self, run: SampleRun) -> bool:
        """Tell whether the samples of a run that comes next command nothing."""
        return run.pedal == bool(self._buttons & TOGGLE_BUTTON) and self._gesture.is_idle_in(run)

    def observe_run(
        self, block: SampleBlock, run: SampleRun, places: tuple[int, int], to_world: Callable[[Vector], Vector]
    ) -> None:
        """Add samples of a run that command nothing, from the first place to before the second."""
        self._buttons = block.buttons[places[1] - 1]
        self._gesture.observe_run(block, run, places, to_world)

    def skip(self, sample: Sample) -> None:
        """Take note of a sample whose commands were followed before."""
        self._buttons = sample.buttons

    def on_object_moved(self, carried: Vector | None) -> None:
        """Take note that the object lies elsewhere [m, world]."""
        self._gesture.carried = carried

    def pop_discard_request(self) -> bool:
        """Return, once, whether a fist has commanded to discard the last demonstration."""
        requested, self._discard_requested = self._discard_requested, False
        return requested
