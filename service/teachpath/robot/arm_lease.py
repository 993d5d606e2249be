"""The lease on the arm: of the services that share a database, one station's alone has an executor for its arm.

Who has given no sign of life for `DEAD_AFTER` counts as dead, and another service may begin in its place. One that was
only cut off from the database must have ended its executor by then.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from typing import Final, Protocol

from teachpath.io.store.services import DEAD_AFTER
from teachpath.periodic_thread import PeriodicThread
from teachpath.robot.processes import STOP_TIMEOUT

WATCH_INTERVAL: Final = 0.5  # [s]
# [s] without a sign of life that the database heard; what then follows is over before others count it as dead
LEASE_TIME: Final = DEAD_AFTER - STOP_TIMEOUT - 4 * WATCH_INTERVAL
LAPSE_NOTE: Final = (
    f"the executor is ended, and nothing moves: the database has not heard of this service for {LEASE_TIME:g} s, and "
    "another one may take its place; the executor is started again when the database answers"
)

log: logging.Logger = logging.getLogger("teachpath")


class Executor(Protocol):
    """The process that moves the arm."""

    def start(self) -> None:
        """Begin to start it."""

    def stop(self) -> None:
        """Let it bring the arm to rest, and end it; returns when it has ended, after `STOP_TIMEOUT` at the most."""


class SignsOfLife(Protocol):
    """What the database hears of this service, and says of others."""

    @property
    def is_shared(self) -> bool:
        """Whether other services can work on the database."""

    @property
    def heard_at(self) -> float:
        """When the database last heard that this service is alive, or a little before [s, monotonic]."""

    @property
    def taken(self) -> str:
        """Why this service has to end: another one is the station's now; empty: none is."""


class ArmLease:
    """Ends the executor when others may soon begin one, and starts it again when that is over.

    Args:
        services: what the database heard of this service.
        executor: of the arm; whoever has the lease has started it.
        clock: [s] monotonic, that of `services`.
    """

    def __init__(
        self, services: SignsOfLife, executor: Executor, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._services, self._executor, self._clock = services, executor, clock
        self._is_held = True
        self._on_taken: Callable[[], object] = lambda: None
        self._thread = PeriodicThread("arm lease", WATCH_INTERVAL, self.watch)

    def start(self) -> None:
        """Watch from now on; where no other service can be, never."""
        if self._services.is_shared:
            self._thread.start()

    def stop(self) -> None:
        """Stop watching."""
        self._thread.stop()

    def when_taken(self, end: Callable[[], object]) -> None:
        """Call `end` when another service is the station's, so that this one ends."""
        self._on_taken = end

    @property
    def taken(self) -> str:
        """Why this service has to end; empty: no other one is the station's."""
        return self._services.taken

    def watch(self) -> None:
        """Look once at how long ago the last sign of life was, and end or start the executor."""
        is_held = not self.taken and self._clock() - self._services.heard_at < LEASE_TIME
        if self._is_held and not is_held:
            self._is_held = False
            self._executor.stop()
            log.error("%s", self.taken or LAPSE_NOTE)
        elif is_held and not self._is_held:
            self._is_held = True
            self._executor.start()
            log.warning("the database has heard of this service again: the executor is started")
        if self.taken:
            self._on_taken()

    def notes(self) -> list[str]:
        """Say what the operator should know."""
        return [] if self._is_held else [self.taken or LAPSE_NOTE]
