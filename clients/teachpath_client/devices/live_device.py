"""What the drivers of live devices share: one connection, readings from its records, and a rate to ask at."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import replace
from types import TracebackType
from typing import Generic, Self, TypeVar

from teachpath_client.devices.connection import Connection
from teachpath_client.reading import HandReading

Record = TypeVar("Record")

READ_TIMEOUT = 0.1  # [s] a read waits


class Polling:
    """Decides when a device is polled: `rate` times a second, without catching up after a pause.

    Args:
        rate: [Hz].
        clock: [s] that never runs back.
    """

    def __init__(self, rate: float, clock: Callable[[], float]) -> None:
        self._step, self._clock = 1.0 / rate, clock
        self._due = float("-inf")

    @property
    def is_due(self) -> bool:
        """Whether a poll is due now; if so, the next one is due a period later."""
        now = self._clock()
        if now < self._due:
            return False
        self._due = self._due + self._step if now - self._due < self._step else now + self._step
        return True

    @property
    def wait(self) -> float:
        """Seconds until the next time."""
        return max(0.0, self._due - self._clock())


class LiveDevice(ABC, Generic[Record]):
    """A source with one connection; a driver converts its records.

    Args:
        connection: with the device; made when the context is entered.
    """

    def __init__(self, connection: Connection[Record]) -> None:
        self.connection: Connection[Record] = connection
        self._over = False

    def __enter__(self) -> Self:
        self.connection.__enter__()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None = None,
        error: BaseException | None = None,
        trace: TracebackType | None = None,
    ) -> None:
        self.close()
        self.connection.__exit__()

    def close(self) -> None:
        """End the iteration soon."""
        self._over = True

    def __iter__(self) -> Iterator[HandReading]:
        start: float | None = None
        while not self._over:
            if (taken := self.next_reading(READ_TIMEOUT)) is not None:
                date, reading = taken
                start = date if start is None else start
                yield replace(reading, time=date - start)

    def next_reading(self, timeout: float) -> tuple[float, HandReading] | None:
        """Return the time [s] on the clock and the next reading, its own time not set; None after `timeout` [s]."""
        taken = self.connection.next_record(timeout)
        reading = None if taken is None else self._reading(taken[1])
        return None if taken is None or reading is None else (taken[0], reading)

    @abstractmethod
    def _reading(self, record: Record) -> HandReading | None:
        """Convert a record to a reading; None when the record is not about the hand."""
