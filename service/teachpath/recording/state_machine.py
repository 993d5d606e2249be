"""The state of a recording: whether it records, counts down, pauses or has lost its tracker, take after take."""

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
        self.made: int = 0  # demonstrations that count in the routine
        self.state: RecordingState = RecordingState.PAUSED
        if not routine.armed:
            self._arm(now)

    def restore(self, state: RecordingState, made: int, now: float) -> None:
        """Go on where another one stopped, whose routine `made` so many demonstrations; a countdown begins anew."""
        self.made, self.state = made, state
        if state is RecordingState.COUNTDOWN:
            self._arm(now)

    @property
    def takes_left(self) -> int:
        """How many demonstrations the routine still wants; 0: it sets no number."""
        return max(self._routine.takes - self.made, 0)

    def countdown_left(self, now: float) -> float:
        """Return the time until the countdown ends [s]; 0 when none runs."""
        return max(0.0, self._begins_at - now) if self.state is RecordingState.COUNTDOWN else 0.0

    def pause(self, *, carrying: bool) -> None:
        """Record nothing until `resume`; a take whose object is carried now is recorded to its end first."""
        if carrying and self.state.is_writing:
            self.state = RecordingState.PAUSING
        else:
            self.state = RecordingState.PAUSED

    def resume(self, now: float) -> None:
        """Record again, or cancel a pause that has not begun; a lost tracker must come back first."""
        if self.state is RecordingState.PAUSING:
            self.state = RecordingState.RECORDING
        elif self.state is RecordingState.PAUSED:
            if self._routine.takes and not self.takes_left:
                self.made = 0  # another series
            self._arm(now)

    def poll_countdown(self, now: float) -> bool:
        """Begin to record when the countdown has ended; return whether it ended with this call."""
        if self.state is not RecordingState.COUNTDOWN or now < self._begins_at:
            return False
        self.state = RecordingState.RECORDING
        return True

    def on_tracker_lost(self) -> None:
        """Take note that the tracker has gone."""
        if self.state.is_writing:
            self.state = RecordingState.LOST

    def on_sample(self) -> None:
        """Take note that the tracker sends."""
        if self.state is RecordingState.LOST:
            self.state = RecordingState.RECORDING

    def end_take(self, now: float, *, made: bool) -> None:
        """Take note that a take has ended, and prepare the next; `made`: it became a demonstration."""
        self.made += made
        enough = self._routine.takes and not self.takes_left
        if self.state is RecordingState.PAUSING or (made and (enough or self._routine.one_by_one)):
            self.state = RecordingState.PAUSED
        elif self.state is RecordingState.RECORDING:
            self._arm(now)

    def withdraw_take(self, *, counted: bool) -> None:
        """Take note that a take became no demonstration, although it `counted` as made; a pause that it made stays."""
        self.made = max(self.made - counted, 0)

    def _arm(self, now: float) -> None:
        self._begins_at = now + self._countdown
        self.state = RecordingState.COUNTDOWN if self._countdown else RecordingState.RECORDING
