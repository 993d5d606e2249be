"""The steps of a device's clock from sample to sample: which of them neither the numbers nor our clock explain."""

from __future__ import annotations

from teachpath.recording.sample_runs import SampleBlock
from teachpath.records import Sample

MAX_CLOCK_RATE = 100.0  # device seconds in one of ours; beyond it the receive times come from a burst
PERIOD_TOLERANCE = 0.1  # share by which the time between numbers may differ from the usual one
TRANSIT_WINDOW = 256  # samples whose least transit time is remembered, at least


class ClockSteps:
    """Follows the steps of one device's clock.

    Args:
        declared_rate: [Hz] that the client declares; 0: it declares none.
        largest_step: [s] by which a step may exceed what explains it.

    Attributes:
        clock_jumps: steps that nothing explains.
        steps: numbers passed by all other steps.
        device_ns: the time that they took by the device's clock.
        step_ns: newest of them; 0: it was a jump, or there is none.
    """

    def __init__(self, declared_rate: float, largest_step: float) -> None:
        self._declared_rate = declared_rate
        self._limit_ns = round(largest_step * 1e9)
        self.clock_jumps: int = 0
        self.steps: int = 0
        self.device_ns: int = 0
        self.step_ns: int = 0
        self._receive_ns = 0
        self._stalled_ns = 0.0
        self._last: tuple[int, int] | None = None  # device_ns and receive_ns of the newest sample
        self._least = self._least_before = float("inf")  # transit times [ns]
        self._transits = 0

    @property
    def period_ns(self) -> float:
        """Time from one number to the next; 0: not known yet."""
        return 1e9 / self._declared_rate if self._declared_rate else self.device_ns / max(self.steps, 1)

    def explains(self, device_ns: int, numbers: int) -> bool:
        """Tell whether a time by the device's clock suits a distance in numbers, as far as the period is known."""
        due = numbers * self.period_ns
        return device_ns >= 0 and (not due or abs(device_ns - due) <= self._limit_ns + PERIOD_TOLERANCE * due)

    def restart(self) -> None:
        """Forget the newest sample, because the device was away."""
        self._last = None
        self._forget_transits()

    def observe(self, sample: Sample, numbers: int) -> int | None:
        """Add the next sample, `numbers` after the one before; return the jump of the clock [ns] that it shows."""
        last, self._last, self.step_ns = self._last, (sample.device_ns, sample.receive_ns), 0
        if last is None:
            self._add_transits(sample.receive_ns - sample.device_ns, 1)
            return None
        device, receive = sample.device_ns - last[0], sample.receive_ns - last[1]
        if 0 < device <= self._limit_ns:  # nearly every step: it needs no explanation
            jump, self._stalled_ns = None, 0.0
        else:
            jump = self._jump(sample, numbers, device, receive)
        if jump is not None:
            self.clock_jumps += 1
            self._forget_transits()
        else:
            self.steps += numbers
            self.device_ns += device
            self._receive_ns += receive
            self.step_ns = device
        self._add_transits(sample.receive_ns - sample.device_ns, 1)
        return jump

    def continues(self, device_ns: int) -> bool:
        """Tell whether a sample that comes next with this time is a step that needs no explanation."""
        return self._last is not None and 0 < device_ns - self._last[0] <= self._limit_ns

    def observe_run(self, block: SampleBlock, begin: int, end: int) -> int:
        """Add the samples of a run that continues the newest one; return its longest step [ns]."""
        assert self._last is not None, "a run continues a sample"
        first, last = self._last, (block.device_ns[end - 1], block.receive_ns[end - 1])
        self._last, self._stalled_ns = last, 0.0
        self.steps += end - begin
        self.device_ns += last[0] - first[0]
        self._receive_ns += last[1] - first[1]
        steps = [block.device_ns[begin] - first[0], *block.step_ns[begin + 1 : end]]
        self.step_ns = steps[-1]
        while begin < end:
            until = min(end, begin + TRANSIT_WINDOW - self._transits)
            self._add_transits(min(block.transit_ns[begin:until]), until - begin)
            begin = until
        return max(steps)

    def _jump(self, sample: Sample, numbers: int, device: int, receive: int) -> int | None:
        if device < 0:
            return device
        stalled, self._stalled_ns = self._stalled_ns, 0.0
        if device == 0:
            self._stalled_ns = stalled + numbers * self.period_ns
            return 0 if stalled <= self._limit_ns < self._stalled_ns else None
        return None if self._is_explained(sample, numbers, device - self._limit_ns, receive) else device

    def _is_explained(self, sample: Sample, numbers: int, excess: int, receive: int) -> bool:
        """Tell whether the numbers explain a step (loss), or our clock does (a pause, also behind a slow transit)."""
        if excess <= 0:
            return True
        rate = min(max(self.device_ns / max(self._receive_ns, 1), 1.0), MAX_CLOCK_RATE)
        if excess <= max(numbers * self.period_ns, receive * rate):
            return True
        # A clock that was set ahead leaves less transit than there ever was; a pause after a slow transit does not.
        transit = sample.receive_ns - sample.device_ns
        return rate < 2.0 and transit >= min(self._least, self._least_before) - self._limit_ns

    def _add_transits(self, least: int, count: int) -> None:
        if least < self._least:
            self._least = least
        self._transits += count
        if self._transits == TRANSIT_WINDOW:  # a clock that drifts is compared with its own last minutes only
            self._least_before, self._least, self._transits = self._least, float("inf"), 0

    def _forget_transits(self) -> None:
        self._least = self._least_before = float("inf")
        self._transits = 0
