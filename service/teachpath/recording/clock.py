"""The clock of a device against the host's: offset, uncertainty and rate."""

from __future__ import annotations

from array import array

import numpy as np

from teachpath.recording.sample_runs import SampleBlock
from teachpath.records import Clock, Sample

WINDOW_SIZE = 500  # newest samples that are used: 10 s of a 50 Hz tracker
MIN_SAMPLES = 10  # for an estimate
REAL_TIME_TOLERANCE = 0.02  # a rate that differs from 1 by less is 1, measured with jitter


class DeviceClock:
    """Follows the clock of one device."""

    def __init__(self) -> None:
        # Ring buffers: each sample is put in, and hundreds of clocks are estimated as arrays several times a second.
        self._device = array("q", bytes(8 * WINDOW_SIZE))
        self._receive = array("q", bytes(8 * WINDOW_SIZE))
        self._observed = 0

    def observe(self, sample: Sample) -> None:
        """Add the times of the next sample."""
        place = self._observed % WINDOW_SIZE
        self._device[place], self._receive[place] = sample.device_ns, sample.receive_ns
        self._observed += 1

    def observe_run(self, block: SampleBlock, begin: int, end: int) -> None:
        """Add the times of the next samples."""
        begin = max(begin, end - WINDOW_SIZE)
        place = self._observed % WINDOW_SIZE
        first = min(end - begin, WINDOW_SIZE - place)  # that fit behind the newest; the others go to the beginning
        for ring, times in ((self._device, block.device_ns), (self._receive, block.receive_ns)):
            ring[place : place + first] = array("q", times[begin : begin + first])
            ring[: end - begin - first] = array("q", times[begin + first : end])
        self._observed += end - begin

    def restart(self) -> None:
        """Forget all samples, because the clock has jumped."""
        self._observed = 0

    def estimate(self) -> Clock | None:
        """Return the estimate at the newest sample, or None after too few samples.

        A receive time is the device time divided by the rate, plus an offset, plus a transit time that is never
        negative. The rate is fitted by least squares; the offset is that of the sample with the least transit time.
        """
        if self._observed < MIN_SAMPLES:
            return None
        filled, newest = min(self._observed, WINDOW_SIZE), (self._observed - 1) % WINDOW_SIZE
        first_receive = self._receive[0]
        device = (np.frombuffer(self._device, np.int64)[:filled] - self._device[0]) * 1e-9
        receive = (np.frombuffer(self._receive, np.int64)[:filled] - first_receive) * 1e-9
        away = device - device.mean()
        spread = float(away @ away)
        slope = float(away @ receive) / spread if spread else 1.0
        if slope <= 0.0:
            return None  # all were received at once
        rate = 1.0 / slope
        if abs(rate - 1.0) <= REAL_TIME_TOLERANCE:
            slope = 1.0
        transit = receive - slope * device  # plus a constant
        least = float(transit.min())
        due = first_receive + round(1e9 * (slope * float(device[newest]) + least))
        return Clock(due - self._device[newest], round(1e9 * (float(np.median(transit)) - least)), rate)


def rate_notes(clock: Clock | None) -> tuple[str, ...]:
    """Return a sentence when a clock does not run as ours."""
    if clock is None or abs(clock.rate - 1.0) <= REAL_TIME_TOLERANCE:
        return ()
    return (f"the device's clock runs {clock.rate:.3g} x ours",)
