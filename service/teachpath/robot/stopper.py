"""Stops the arm: puts the stop and asks for it, again and again, until the executor's own status shows it."""

from __future__ import annotations

import threading
import time
import uuid
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Final

from teachpath.errors import NotStopped, TeachpathError
from teachpath.io.bus import Bus
from teachpath.io.wire import encode_command
from teachpath.logs import request_number
from teachpath.records import Command, ExecutorStatus
from teachpath_proto.keys import Keys

REPEAT_INTERVAL: Final = 0.05  # [s] between two repeats of a stop that is not confirmed
CONFIRM_TIMEOUT: Final = 2.0  # [s] after which whoever asked for the stop hears that it is not confirmed
REPEAT_DURATION: Final = 60.0  # [s] for which an unconfirmed stop is repeated in all
SLOW_REPEAT_INTERVAL: Final = 0.5  # [s] between two repeats after `CONFIRM_TIMEOUT`: they wait in a hung executor


@dataclass(frozen=True)
class PendingStop:
    """A stop that is not confirmed yet."""

    command: Command
    is_starting: Callable[[], bool]  # whether what it stops may be about to begin
    start_time: float  # [s of the monotonic clock]


class Stopper:
    """Sends stops and waits for the executor's status; safe to use from several threads.

    A question can be answered in the executor's place, and a put is answered by nobody: so a stop is both, and what it
    is believed by is neither, but the status that the executor publishes afterwards.
    """

    def __init__(self, bus: Bus, keys: Keys) -> None:
        self._bus, self._key = bus, keys.executor_stop
        self._changed = threading.Condition()
        self._status: ExecutorStatus | None = None
        self._received = 0.0  # when the newest status came [s of the monotonic clock]
        self._repeating: dict[str, threading.Thread] = {}  # by execution
        self._closed = False
        self.outcomes: dict[str, int] = {"confirmed": 0, "not_confirmed": 0}  # of the stops that were ordered

    @property
    def is_repeating(self) -> bool:
        """Whether a stop waits to be confirmed."""
        return bool(self._repeating)

    def on_status(self, status: ExecutorStatus) -> None:
        """Take the executor's newest status."""
        with self._changed:
            self._status, self._received = status, time.monotonic()
            self._changed.notify_all()

    def stop(self, command: Command, is_starting: Callable[[], bool]) -> ExecutorStatus:
        """Send a stop until the executor's status shows it, and return that status.

        Args:
            command: whose `execution` is to be stopped; an empty one stands for whatever moves.
            is_starting: tells whether that execution was sent to the executor and is not known to have begun.

        Raises:
            NotStopped: the status does not show it within `CONFIRM_TIMEOUT`; it is repeated up to `REPEAT_DURATION`.
        """
        stop = self.send(command, is_starting)
        with self._changed:
            is_confirmed = self._changed.wait_for(lambda: self._is_confirmed(stop), CONFIRM_TIMEOUT)
            self.outcomes["confirmed" if is_confirmed else "not_confirmed"] += 1
            if not is_confirmed:
                raise NotStopped(
                    f"NOT STOPPED: the executor has not confirmed the stop within {CONFIRM_TIMEOUT:g} s, and the arm "
                    "may be moving; press the emergency stop of the arm. The stop is repeated for "
                    f"{REPEAT_DURATION:g} s"
                )
            assert self._status is not None
            return self._status

    def send(self, command: Command, is_starting: Callable[[], bool] = lambda: False) -> PendingStop:
        """Send a stop until the executor's status shows it, as `stop` does, and wait for nothing."""
        stop = PendingStop(replace(command, id=request_number() or uuid.uuid4().hex), is_starting, time.monotonic())
        self._send_repeatedly(stop)
        return stop

    def close(self) -> None:
        """Repeat no stop any more."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
            threads = list(self._repeating.values())
        for thread in threads:
            thread.join()

    def _send_repeatedly(self, stop: PendingStop) -> None:
        """Send a stop on a thread of its own, once when an earlier stop of that execution is being repeated."""
        execution = stop.command.execution
        with self._changed:
            is_first = execution not in self._repeating
            thread = threading.Thread(target=self._send, args=(stop, is_first), name="stop", daemon=True)
            if is_first:
                self._repeating[execution] = thread
            thread.start()

    def _send(self, stop: PendingStop, repeats: bool) -> None:
        payload = encode_command(stop.command)
        try:
            while True:
                with suppress(TeachpathError):  # whoever answers is not believed, and whoever does not is put to
                    self._bus.publish(self._key, payload)
                    self._bus.ask(self._key, payload, timeout=REPEAT_INTERVAL)
                elapsed = time.monotonic() - stop.start_time
                interval = REPEAT_INTERVAL if elapsed < CONFIRM_TIMEOUT else SLOW_REPEAT_INTERVAL
                with self._changed:
                    done = self._changed.wait_for(lambda: self._closed or self._is_confirmed(stop), interval)
                if done or not repeats or elapsed > REPEAT_DURATION:
                    return
        finally:
            if repeats:
                with self._changed:
                    del self._repeating[stop.command.execution]

    def _is_confirmed(self, stop: PendingStop) -> bool:
        """Tell whether a status that came since the stop was sent shows it."""
        status, execution = self._status, stop.command.execution
        if status is None or self._received < stop.start_time or stop.is_starting():
            return False
        return status.state.is_resting or status.ending or execution not in ("", status.execution)
