"""The clock of a stream's device: its steps and jumps, its longest gaps, and how it runs against ours."""

from __future__ import annotations

from teachpath.recording.clock import DeviceClock
from teachpath.recording.clock_steps import ClockSteps
from teachpath.recording.sample_runs import SampleBlock
from teachpath.records import Clock, Sample


class StreamClock:
    """Follows one device's clock through the samples that came in order.

    Args:
        declared_rate: [Hz] that the client declares; 0: it declares none.
        largest_step: [s] see `ClockSteps`.

    Attributes:
        steps: from sample to sample.
        longest_gap_ns: longest step that is no jump.
        interval_longest_gap_ns: likewise, in the current interval.
    """

    def __init__(self, declared_rate: float, largest_step: float) -> None:
        self.steps: ClockSteps = ClockSteps(declared_rate, largest_step)
        self._clock = DeviceClock()
        self.longest_gap_ns: int = 0
        self.interval_longest_gap_ns: int = 0

    def restart(self) -> None:
        """Forget the newest sample, because the device was away."""
        self.steps.restart()
        self._clock.restart()

    def begin_interval(self) -> None:
        """Begin another interval."""
        self.interval_longest_gap_ns = 0

    def observe(self, sample: Sample, numbers: int) -> str:
        """Add the next sample, `numbers` after the one before; return a sentence when the clock jumps."""
        jump = self.steps.observe(sample, numbers)
        if jump is None:
            self._keep_gap(self.steps.step_ns)
        else:
            self._clock.restart()
        self._clock.observe(sample)
        if jump is None:
            return ""
        how = f"jumps by {jump * 1e-9:+.3g} s" if jump else "stands still"
        return f"the device's clock {how} at sample {sample.sequence}"

    def observe_run(self, block: SampleBlock, begin: int, end: int) -> None:
        """Add the samples of a run that goes on where the newest sample was."""
        self._keep_gap(self.steps.observe_run(block, begin, end))
        self._clock.observe_run(block, begin, end)

    def estimate(self) -> Clock | None:
        """Return how the clock runs, as `DeviceClock.estimate`."""
        return self._clock.estimate()

    def _keep_gap(self, step_ns: int) -> None:
        self.interval_longest_gap_ns = max(self.interval_longest_gap_ns, step_ns)
        self.longest_gap_ns = max(self.longest_gap_ns, step_ns)
