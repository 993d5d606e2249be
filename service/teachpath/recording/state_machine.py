"""When the samples of a recording are recorded: armed, counted down, paused, lost, take after take."""

from __future__ import annotations

from teachpath.records import RecordingState, Routine


class RecordingStateMachine:
    """Follows the state of one recording; `now` is in seconds of a monotonic clock.

    Args:
        countdown: [s] before each take, where the routine says none.
    """

    def __init__(self, routine: Routine, now: float, *, countdown: float = 0.0) -> None:
        self._routine = routine
        self._countdown = countdown if routine.countdown is None else routine.countdown
        self._begins_at = 0.0  # the take, while it is counted down
        self._made = 0
        self.state = RecordingState.PAUSED
        if not routine.armed:
            self._arm(now)

    @property
    def takes_left(self) -> int:
        """How many takes are still wanted; 0 when nobody has said how many."""
        return max(self._routine.takes - self._made, 0)

    def countdown_left(self, now: float) -> float:
        """Return what is left of the countdown [s]."""
        return max(0.0, self._begins_at - now) if self.state is RecordingState.COUNTDOWN else 0.0

    def pause(self, *, carrying: bool) -> None:
        """Record nothing until `resume`; what is carried is recorded to its end first."""
        if carrying and self.state in (RecordingState.RECORDING, RecordingState.PAUSING):
            self.state = RecordingState.PAUSING
        else:
            self.state = RecordingState.PAUSED

    def resume(self, now: float) -> None:
        """Record again; a lost tracker has to come back for that, and one that was to pause goes on."""
        if self.state is RecordingState.PAUSING:
            self.state = RecordingState.RECORDING
        elif self.state is RecordingState.PAUSED:
            if self._routine.takes and not self.takes_left:
                self._made = 0  # another series
            self._arm(now)

    def poll_countdown(self, now: float) -> bool:
        """Return whether this moment ends the countdown."""
        if self.state is not RecordingState.COUNTDOWN or now < self._begins_at:
            return False
        self.state = RecordingState.RECORDING
        return True

    def on_tracker_lost(self) -> None:
        """Take note that the tracker has gone."""
        if self.state in (RecordingState.RECORDING, RecordingState.PAUSING):
            self.state = RecordingState.LOST

    def on_sample(self) -> None:
        """Take note that the tracker sends."""
        if self.state is RecordingState.LOST:
            self.state = RecordingState.RECORDING

    def end_take(self, now: float, *, made: bool) -> None:
        """Take note that a take has ended, as a demonstration or as nothing, and make ready for the next."""
        self._made += made
        enough = self._routine.takes and not self.takes_left
        if self.state is RecordingState.PAUSING or (made and (enough or self._routine.one_by_one)):
            self.state = RecordingState.PAUSED
        elif self.state is RecordingState.RECORDING:
            self._arm(now)

    def _arm(self, now: float) -> None:
        self._begins_at = now + self._countdown
        self.state = RecordingState.COUNTDOWN if self._countdown else RecordingState.RECORDING
