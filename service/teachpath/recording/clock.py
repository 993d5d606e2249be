"""The clock of a device against ours: offset by the least transit, its uncertainty, and how fast it runs."""

from __future__ import annotations

from collections import deque

import numpy as np

from teachpath.records import Clock, Sample

WINDOW = 500  # newest samples that are looked at: 10 s of a 50 Hz tracker
FEWEST = 10
REAL_TIME = 0.02  # a rate nearer to 1 is a clock that runs with ours, seen through jitter


class DeviceClock:
    """Follows the clock of one device."""

    def __init__(self) -> None:
        self._window: deque[tuple[int, int]] = deque(maxlen=WINDOW)

    def observe(self, sample: Sample) -> None:
        """Take the times of the next sample."""
        self._window.append((sample.device_ns, sample.receive_ns))

    def restart(self) -> None:
        """Forget all before: the clock has jumped."""
        self._window.clear()

    def estimate(self) -> Clock | None:
        """Return how the clock stands at the newest sample, or None after too few samples.

        Receive times are device times divided by the rate, plus an offset, plus a transit that is never negative: the
        rate is that of the line of least squares, the offset that of the fastest sample.
        """
        if len(self._window) < FEWEST:
            return None
        window = list(self._window)
        first_device, first_receive = window[0]
        device = np.array([d - first_device for d, _ in window]) * 1e-9
        receive = np.array([r - first_receive for _, r in window]) * 1e-9
        spread = float(np.var(device))
        slope = float(np.mean((device - device.mean()) * (receive - receive.mean()))) / spread if spread else 1.0
        if slope <= 0.0:
            return None  # received all at once: nothing can be said
        rate = 1.0 / slope
        if abs(rate - 1.0) <= REAL_TIME:
            slope = 1.0
        transit = receive - slope * device  # plus a constant
        least = float(transit.min())
        newest = first_receive + round(1e9 * (slope * float(device[-1]) + least))
        return Clock(newest - window[-1][0], round(1e9 * (float(np.median(transit)) - least)), rate)
