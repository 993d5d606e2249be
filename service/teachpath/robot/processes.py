"""The processes beside the service, executor and simulated arm: started with it, started again when they die.

They are forked from the process server. None outlives the service: each reads its settings from its standard input, and
ends when that is closed.
"""

from __future__ import annotations

import logging
import signal
import sys
import threading
import time
from collections.abc import Callable
from enum import StrEnum
from functools import partial
from importlib import import_module
from typing import Final

from teachpath.logs import relay
from teachpath.robot.forked_process import LOST_EXIT_STATUS, ForkedProcess
from teachpath.robot.last_error import LastError

log: logging.Logger = logging.getLogger("teachpath")

STOP_TIMEOUT: Final = 3.0  # [s] that a process may take to end before it is killed
RESTART_DELAY: Final = 0.5  # [s] between a death and the next start
MAX_DEATHS: Final = 5  # in a row, each within `SHORT_LIFE` of its start; then another start would not help
SHORT_LIFE: Final = 60.0  # [s]
NOTE_TIME: Final = 600.0  # [s] for which a note tells of a death
READ_TIMEOUT: Final = 1.0  # [s] to read what a process wrote before it died
# What an operator should do after the death of a process, as the end of a sentence.
EXECUTOR_SUGGESTION: Final = "its execution ended as faulted: look where the arm stands, then start again"
SIMULATOR_SUGGESTION: Final = (
    "its execution ended as faulted; its arm stands at home and the object at its start: start again"
)


class ProcessState(StrEnum):
    """Whether a process beside the service runs."""

    RUNNING = "running"
    RESTARTING = "restarting"
    ENDED = "ended"  # it was stopped, or has died too often


def attached(name: str) -> Callable[[], None]:
    """Return what runs a part of the station in a process beside the service: `teachpath NAME --attached`."""
    return partial(_run_command, name, "--attached")


def _run_command(*arguments: str) -> None:
    sys.argv[1:] = arguments
    import_module("teachpath.__main__").main()


class SupervisedProcess:
    """A process that is started again when it dies, unless it has died too often.

    Args:
        name: of the part, for the operator.
        function: what it runs; it can be pickled.
        instructions: one line for its standard input.
        suggestion: what the operator should do after a death, as the end of a sentence.
        on_death: called with the cause of each death, before the process is started again.
    """

    def __init__(
        self,
        name: str,
        function: Callable[[], object],
        instructions: str,
        *,
        suggestion: str,
        on_death: Callable[[str], None] = lambda cause: None,
    ) -> None:
        self.name: str = name
        self._function = function
        self._instructions = instructions
        self._suggestion = suggestion
        self._on_death = on_death
        self._lock = threading.Lock()
        self._stopping = threading.Event()
        self._process: ForkedProcess | None = None
        self._supervisor: threading.Thread | None = None
        self._started_at = 0.0  # [s, monotonic]
        self._short_lives = 0  # in a row
        self._death: tuple[float, str] | None = None  # the last one: when [s, monotonic], and its cause

    def start(self) -> None:
        """Begin to start the process, which waits for the process server; it announces itself on the bus.

        One that was stopped is started again.
        """
        self._stopping.clear()
        self._supervisor = threading.Thread(target=self._supervise, name=f"{self.name} supervisor", daemon=True)
        self._supervisor.start()

    def is_alive(self) -> bool:
        """Tell whether the process runs."""
        return self._process is not None and self._process.is_alive()

    @property
    def state(self) -> ProcessState:
        """Running, from `start` on, restarting, or ended when it is stopped or has died too often."""
        if self.is_alive():
            return ProcessState.RUNNING
        if self.is_given_up or self._stopping.is_set():
            return ProcessState.ENDED
        return ProcessState.RESTARTING if self._process or self._death else ProcessState.RUNNING

    def note(self) -> str:
        """Return what the operator should know and do about the last death; empty when it is long ago."""
        if self._death is None:
            return ""
        at, cause = self._death
        if self.is_given_up:
            often = f"the {self.name} died {MAX_DEATHS} times, each within {SHORT_LIFE:g} s of its start"
            return f"{often}, and is not started again ({cause}); mend the cause, then restart the service"
        if time.monotonic() - at > NOTE_TIME:
            return ""
        return f"the {self.name} died ({cause}) and was started again; {self._suggestion}"

    @property
    def is_given_up(self) -> bool:
        """Whether it has died so often that it is not started again."""
        return self._short_lives >= MAX_DEATHS

    def request_stop(self) -> None:
        """Ask the process to end by itself; it is not started again."""
        self._stopping.set()
        with self._lock:
            if self._process is not None:
                self._process.send_signal(signal.SIGTERM)

    def stop(self) -> None:
        """End the process; it is killed when it does not end in time."""
        self.request_stop()
        if self._process is not None:
            self._process.close_input()
        if self._supervisor is not None:
            self._supervisor.join(STOP_TIMEOUT)
            if self._process is not None:
                self._process.send_signal(signal.SIGKILL)
            self._supervisor.join()

    def _supervise(self) -> None:
        while not self._stopping.is_set():
            cause = self._run()
            if self._stopping.is_set():
                return
            self._note_death(cause)
            if self.is_given_up or self._stopping.wait(RESTART_DELAY):
                return

    def _run(self) -> str:
        """Start the process, wait until it has ended, and return how, in words."""
        with self._lock:
            if self._stopping.is_set():
                return ""
            self._started_at = time.monotonic()
            try:
                process = self._process = ForkedProcess(self.name, self._function)
            except (OSError, EOFError) as error:
                return f"it cannot be started: {error}"
            process.write_line(self._instructions)
        return self._wait_for_end(process)

    def _note_death(self, cause: str) -> None:
        now = time.monotonic()
        self._short_lives = self._short_lives + 1 if now - self._started_at < SHORT_LIFE else 0
        self._death = (now, cause)
        log.error("the %s died: %s", self.name, cause)
        try:
            self._on_death(cause)
        except Exception:  # whatever it is, the process must be started again
            log.exception("what follows the death of the %s failed", self.name)

    def _wait_for_end(self, process: ForkedProcess) -> str:
        error = LastError()
        reader = threading.Thread(target=self._read, args=(process, error), name=f"{self.name} stderr", daemon=True)
        reader.start()
        status = process.wait()
        reader.join(READ_TIMEOUT)
        process.close_input()
        return _describe_end(status, error.text)

    def _read(self, process: ForkedProcess, error: LastError) -> None:
        """Pass on what a process writes, and look for its last error."""
        with open(process.errors, encoding="utf-8", errors="replace") as lines:
            for line in lines:
                try:
                    told = relay(line)
                except ValueError:  # of a library, or of Python itself
                    told = line
                    sys.stderr.write(f"{self.name}: {line}")
                for each in told.splitlines(keepends=True):
                    error.add(each)


def _describe_end(returncode: int, error: str) -> str:
    """Return in words how a process ended, with its last error if it wrote one."""
    if returncode == LOST_EXIT_STATUS:
        how = "the process server ended, which it was forked from"
    elif returncode < 0:
        how = f"killed by signal {-returncode}, {signal.strsignal(-returncode)}"
    else:
        how = f"exit status {returncode}" if returncode else "it ended by itself"
    return f"{how}: {error}" if error else how
