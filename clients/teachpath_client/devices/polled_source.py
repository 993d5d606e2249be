"""What the sources share that ask a device at a fixed rate, by a library of its maker or of its class."""

from __future__ import annotations

import logging
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import replace
from types import TracebackType
from typing import Self

from teachpath_client.devices.connection import FIRST_RETRY_WAIT, MAX_RETRY_WAIT
from teachpath_client.devices.live_device import Polling
from teachpath_client.devices.source import Capabilities
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading

LOG = logging.getLogger(__name__)


class PolledSource(ABC):
    """Readings at a fixed rate; a device that has gone is tried again until it is back, and gives none meanwhile.

    Args:
        rate: [Hz] of asking.
        clock: [s] that never runs back.
        sleep: waits some seconds.
    """

    def __init__(
        self,
        rate: float,
        *,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], object] = time.sleep,
    ) -> None:
        self._rate, self._clock, self._sleep = rate, clock, sleep
        self._over = False

    @property
    def capabilities(self) -> Capabilities:
        """Poses, live, at the rate of asking."""
        return Capabilities(rate=self._rate, sensors=0, orientation=True, live=True)

    def __enter__(self) -> Self:
        self._connect()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None = None,
        error: BaseException | None = None,
        trace: TracebackType | None = None,
    ) -> None:
        self.close()
        self._disconnect()

    def close(self) -> None:
        """End the iteration soon."""
        self._over = True

    def __iter__(self) -> Iterator[HandReading]:
        polling, start = Polling(self._rate, self._clock), self._clock()
        while not self._over:
            self._sleep(polling.wait)
            if not polling.is_due:
                continue
            try:
                reading = self._ask()
            except ClientError as error:
                LOG.warning("%s; trying again until it is back", error)
                self._disconnect()
                self._reconnect()
                continue
            if reading is not None:
                yield replace(reading, time=self._clock() - start)

    @abstractmethod
    def _connect(self) -> None:
        """Connect with the device; raises ClientError when there is none."""

    @abstractmethod
    def _disconnect(self) -> None:
        """Let go of the device; a second call does nothing."""

    @abstractmethod
    def _ask(self) -> HandReading | None:
        """Return what the device measures now, if anything; raises ClientError when it has gone."""

    def _reconnect(self) -> None:
        wait = FIRST_RETRY_WAIT
        while not self._over:
            self._sleep(wait)
            wait = min(2 * wait, MAX_RETRY_WAIT)
            try:
                self._connect()
            except ClientError:
                continue
            LOG.warning("the device answers again")
            return
