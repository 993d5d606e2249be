"""The processes beside the service, executor and simulated arm: started with it, started again when they die.

None outlives the service: each reads its settings from its standard input, and ends when that is closed.
"""

from __future__ import annotations

import contextlib
import logging
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from typing import Final

from teachpath.logs import relay
from teachpath.robot.last_error import LastError

log = logging.getLogger("teachpath")

STOP_TIMEOUT: Final = 3.0  # [s] that a process may take to end before it is killed
RESTART_DELAY: Final = 0.5  # [s] between a death and the next start
MAX_DEATHS: Final = 5  # in a row, each within `SHORT_LIFE` of its start; then another start would not help
SHORT_LIFE: Final = 60.0  # [s]
NOTE_TIME: Final = 600.0  # [s] for which a note tells of a death
READ_TIMEOUT: Final = 1.0  # [s] to read what a process wrote before it died


def attached_command(name: str) -> Sequence[str]:
    """Return the command that runs a part of the station as a process beside the service."""
    return (sys.executable, "-m", "teachpath", name, "--attached")


class SupervisedProcess:
    """A process that is started again when it dies, unless it has died too often.

    Args:
        name: of the part, for the operator.
        command: what to run.
        instructions: one line for its standard input.
        suggestion: what the operator should do after a death, as the end of a sentence.
        on_death: called with the cause of each death, before the process is started again.
    """

    def __init__(
        self,
        name: str,
        command: Sequence[str],
        instructions: str,
        *,
        suggestion: str,
        on_death: Callable[[str], None] = lambda cause: None,
    ) -> None:
        self.name = name
        self._command = command
        self._instructions = instructions
        self._suggestion = suggestion
        self._on_death = on_death
        self._lock = threading.Lock()
        self._stopping = threading.Event()
        self._process: subprocess.Popen[str] | None = None
        self._supervisor: threading.Thread | None = None
        self._started_at = 0.0  # [s, monotonic]
        self._short_lives = 0  # in a row
        self._death: tuple[float, str] | None = None  # the last one: when [s, monotonic], and its cause

    def start(self) -> None:
        """Start the process; it is ready when it announces itself on the bus."""
        self._supervisor = threading.Thread(target=self._supervise, name=f"{self.name} supervisor", daemon=True)
        self._spawn()
        self._supervisor.start()

    def is_alive(self) -> bool:
        """Tell whether the process runs."""
        return self._process is not None and self._process.poll() is None

    @property
    def state(self) -> str:
        """`running`, `restarting`, or `ended` when it is stopped or has died too often."""
        if self.is_alive():
            return "running"
        return "ended" if self.is_given_up or self._stopping.is_set() else "restarting"

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
            if self.is_alive():
                assert self._process is not None
                self._process.send_signal(signal.SIGTERM)

    def stop(self) -> None:
        """End the process; it is killed when it does not end in time."""
        self.request_stop()
        process = self._process
        if process is None:
            return
        with contextlib.suppress(OSError):
            process.stdin.close()  # type: ignore[union-attr]
        try:
            process.wait(STOP_TIMEOUT)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        if self._supervisor is not None:
            self._supervisor.join()

    def _spawn(self) -> None:
        with self._lock:
            if self._stopping.is_set():
                return
            self._started_at = time.monotonic()
            self._process = subprocess.Popen(
                self._command,
                stdin=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                errors="replace",
                # its own session: Ctrl-C goes to the service alone, which then stops its parts in order
                start_new_session=True,
            )
            assert self._process.stdin is not None
            with contextlib.suppress(OSError):  # it may have died already
                self._process.stdin.write(self._instructions + "\n")
                self._process.stdin.flush()

    def _supervise(self) -> None:
        cause = self._wait_for_end()
        while not self._stopping.is_set():
            self._note_death(cause)
            if self.is_given_up or self._stopping.wait(RESTART_DELAY):
                return
            try:
                self._spawn()
            except OSError as error:
                cause = f"it cannot be started: {error}"
            else:
                cause = self._wait_for_end()

    def _note_death(self, cause: str) -> None:
        now = time.monotonic()
        self._short_lives = self._short_lives + 1 if now - self._started_at < SHORT_LIFE else 0
        self._death = (now, cause)
        log.error("the %s died: %s", self.name, cause)
        try:
            self._on_death(cause)
        except Exception:  # whatever it is, the process must be started again
            log.exception("what follows the death of the %s failed", self.name)

    def _wait_for_end(self) -> str:
        """Wait until the process has ended, and return how, in words."""
        process = self._process
        assert process is not None
        error = LastError()
        reader = threading.Thread(target=self._read, args=(process, error), name=f"{self.name} stderr", daemon=True)
        reader.start()
        process.wait()
        reader.join(READ_TIMEOUT)
        with contextlib.suppress(OSError):
            process.stdin.close()  # type: ignore[union-attr]
        return _describe_end(process.returncode, error.text)

    def _read(self, process: subprocess.Popen[str], error: LastError) -> None:
        """Pass on what a process writes, and look for its last error."""
        assert process.stderr is not None
        with process.stderr as lines:
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
    if returncode < 0:
        how = f"killed by signal {-returncode}, {signal.strsignal(-returncode)}"
    else:
        how = f"exit status {returncode}" if returncode else "it ended by itself"
    return f"{how}: {error}" if error else how
