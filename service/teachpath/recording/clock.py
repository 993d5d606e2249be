"""The clock of a device against ours: offset by the least transit, its uncertainty, and how fast it runs."""

from __future__ import annotations

import numpy as np

from teachpath.records import Clock, Sample

WINDOW_SIZE = 500  # newest samples that are looked at: 10 s of a 50 Hz tracker
MIN_SAMPLES = 10
REAL_TIME_TOLERANCE = 0.02  # a rate nearer to 1 is a clock that runs with ours, seen through jitter


class DeviceClock:
    """Follows the clock of one device."""

    def __init__(self) -> None:
        # a ring of arrays: hundreds of trackers are asked several times a second
        self._device = np.zeros(WINDOW_SIZE, dtype=np.int64)
        self._receive = np.zeros(WINDOW_SIZE, dtype=np.int64)
        self._observed = 0

    def observe(self, sample: Sample) -> None:
        """Take the times of the next sample."""
        place = self._observed % WINDOW_SIZE
        self._device[place], self._receive[place] = sample.device_ns, sample.receive_ns
        self._observed += 1

    def restart(self) -> None:
        """Forget all before: the clock has jumped."""
        self._observed = 0

    def estimate(self) -> Clock | None:
        """Return how the clock stands at the newest sample, or None after too few samples.

        Receive times are device times divided by the rate, plus an offset, plus a transit that is never negative: the
        rate is that of the line of least squares, the offset that of the fastest sample.
        """
        if self._observed < MIN_SAMPLES:
            return None
        filled, newest = min(self._observed, WINDOW_SIZE), (self._observed - 1) % WINDOW_SIZE
        first_device, first_receive = int(self._device[0]), int(self._receive[0])
        device = (self._device[:filled] - first_device) * 1e-9
        receive = (self._receive[:filled] - first_receive) * 1e-9
        away = device - device.mean()
        spread = float(away @ away)
        slope = float(away @ receive) / spread if spread else 1.0
        if slope <= 0.0:
            return None  # received all at once: nothing can be said
        rate = 1.0 / slope
        if abs(rate - 1.0) <= REAL_TIME_TOLERANCE:
            slope = 1.0
        transit = receive - slope * device  # plus a constant
        least = float(transit.min())
        due = first_receive + round(1e9 * (slope * float(device[newest]) + least))
        return Clock(due - int(self._device[newest]), round(1e9 * (float(np.median(transit)) - least)), rate)
