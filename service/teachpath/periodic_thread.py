"""A thread that does one thing again and again until it is stopped."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from typing import Protocol

log: logging.Logger = logging.getLogger("teachpath")


class Startable(Protocol):
    """A part that works on threads of its own from its start on."""

    def start(self) -> object:
        """Begin to work."""


class Stoppable(Protocol):
    """A part that can be ended."""

    def stop(self) -> object:
        """End what it does."""


class PeriodicThread:
    """Calls an action on a thread of its own, with a pause before each call; it can be started again after a stop.

    An action that raises is called again after the pause. Its error is logged, but not when it repeats the one before:
    a disk that stays full would fill the log.

    Args:
        name: of the thread, for logs and debuggers.
        interval: [s] pause before each call.
        action: what to do; when it returns True, the next call follows without a pause.
    """

    def __init__(self, name: str, interval: float, action: Callable[[], bool | None]) -> None:
        self._name = name
        self._interval = interval
        self._action = action
        self._stopped = threading.Event()
        self._thread: threading.Thread | None = None

    @property
    def is_running(self) -> bool:
        """Whether the thread was started and not stopped since."""
        return self._thread is not None

    def start(self) -> None:
        """Call the action from now on."""
        self._stopped.clear()
        self._thread = threading.Thread(target=self._run, name=self._name, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Wait until the call that is under way has returned, and make no other; a second stop does nothing."""
        self._stopped.set()
        thread, self._thread = self._thread, None
        if thread is not None:
            thread.join()

    def _run(self) -> None:
        pause, last_error = self._interval, ""
        while not self._stopped.wait(pause):
            pause = self._interval
            try:
                if self._action():
                    pause = 0.0
                last_error = ""
            except Exception as error:  # whatever went wrong this time must not end the times after it
                if repr(error) != last_error:
                    log.exception("%s failed; trying again every %g s", self._name, self._interval)
                last_error = repr(error)
