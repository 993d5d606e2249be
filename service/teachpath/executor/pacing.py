"""Wakes a control loop at absolute deadlines and keeps statistics of how late it woke."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.time_source import TimeSource

MAX_COUNTED_LATENESS_US: Final = 20_000  # a larger lateness counts as this one in the percentiles


@dataclass(frozen=True, slots=True)
class Lateness:
    """How late a loop woke [us], over all counted cycles."""

    p50: float
    p99: float
    largest: float


class Pacer:
    """Absolute deadlines, one a period: deadlines that a long cycle missed are skipped, never made up for by a burst.

    Args:
        period_ns: between two deadlines [ns].

    Attributes:
        cycles: counted cycles.
        late: counted cycles that woke later than half a period.
        missed: deadlines that were skipped.
    """

    def __init__(self, period_ns: int, time_source: TimeSource) -> None:
        self._period = period_ns
        self._clock = time_source.monotonic_ns
        self._sleep, self._doze = time_source.sleep, time_source.wait
        self._due = self._clock()
        self.reset()

    def reset(self) -> None:
        """Begin the statistics anew."""
        self.cycles: int = 0
        self.late: int = 0
        self.missed: int = 0
        self._largest = 0.0
        self._counts = np.zeros(MAX_COUNTED_LATENESS_US + 1, dtype=np.int64)  # one bin a microsecond

    def wait(self, periods: int = 1, *, counted: bool = True, woken: threading.Event | None = None) -> int:
        """Sleep until the deadline that lies `periods` ahead, and return it [ns of the clock].

        Args:
            counted: whether this cycle enters the statistics.
            woken: once it is set, the next deadline is waited for, and none beyond it.
        """
        self._due += periods * self._period
        ahead = self._due - self._clock()
        if woken is not None and ahead > self._period:
            self._doze(woken, ahead / 1e9)
            if woken.is_set():
                self._due -= max(self._due - self._clock() - 1, 0) // self._period * self._period
            ahead = self._due - self._clock()
        if ahead > 0:
            self._sleep(ahead / 1e9)
        behind = max(self._clock() - self._due, 0)
        skipped = behind // self._period
        self._due += skipped * self._period
        if counted:
            self._count(behind, skipped)
        return self._due

    def lateness(self) -> Lateness:
        """Return the lateness since the last reset."""
        if self.cycles == 0:
            return Lateness(0.0, 0.0, 0.0)
        below = np.cumsum(self._counts)
        p50, p99 = (float(np.searchsorted(below, share * self.cycles)) for share in (0.5, 0.99))
        return Lateness(p50, p99, self._largest)

    def _count(self, behind: int, skipped: int) -> None:
        self.late += 2 * behind > self._period
        self.missed += skipped
        self.cycles += 1
        self._largest = max(self._largest, behind / 1e3)
        self._counts[min(behind // 1000, MAX_COUNTED_LATENESS_US)] += 1


class NominalClock:
    """Stamps the setpoints of one execution.

    The stamp advances by exactly one period per setpoint; time lost by an overslept loop is not made up. So position,
    velocity and acceleration always belong to their times.

    Args:
        rate: setpoints a second [Hz].
        offset: what turns the loop's clock into nanoseconds since the Unix epoch, when added [ns].
    """

    def __init__(self, rate: float, offset: int) -> None:
        self._period_ns = round(1e9 / rate)
        self._offset = offset
        self._newest_ns: int | None = None

    def stamp(self, due: int, *, at_rest: bool) -> int:
        """Return the nominal time of the next setpoint [ns since the Unix epoch].

        Args:
            due: when its period began [ns of the loop's clock].
            at_rest: whether two setpoints of the standstill were sent; then the stamp returns to the present.
        """
        newest = self._newest_ns
        self._newest_ns = due + self._offset if at_rest or newest is None else newest + self._period_ns
        return self._newest_ns
