"""A process forked from the process server, with pipes for its standard input and its error stream.

The server has loaded the libraries that the executor and the simulated arm need; a Python of their own would load them
anew, at each start for a second or two of a processor.
"""

from __future__ import annotations

import contextlib
import gc
import os
import signal
import sys
from collections.abc import Callable
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from multiprocessing.popen_forkserver import Popen
from typing import Final

from teachpath.process_server import CONTEXT, process_start

LOST_EXIT_STATUS: Final = 255  # exit status of a process whose server has died, and which nobody can wait for any more


class ForkedProcess:
    """A function in a process of its own session: Ctrl-C goes to the service alone, which then stops its parts.

    One thread waits for its end.

    Args:
        name: of the process, as the system shows it.
        function: what it runs; it can be pickled.

    Raises:
        OSError, EOFError: it cannot be started.

    Attributes:
        pid: its id.
        errors: the file descriptor from which its error stream is read; it belongs to whoever reads.
    """

    def __init__(self, name: str, function: Callable[[], object]) -> None:
        (reader, self._input), (errors, writer) = Pipe(duplex=False), Pipe(duplex=False)
        with reader, writer, errors:
            try:
                process = CONTEXT.Process(target=_run, args=(name, function, reader, writer), name=name)
                with process_start():
                    # Not by `start`, which lets every thread that starts a process read how this one has ended.
                    self._popen = Popen(process)
            except BaseException:
                self._input.close()
                raise
            self.pid: int = self._popen.pid
            self.errors: int = os.dup(errors.fileno())
        self._has_ended = False

    def is_alive(self) -> bool:
        """Tell whether its end has not been seen yet."""
        return not self._has_ended

    def write_line(self, line: str) -> None:
        """Write a line to its standard input."""
        rest = line.encode() + b"\n"
        with contextlib.suppress(OSError):  # it may have died already
            while rest:
                rest = rest[os.write(self._input.fileno(), rest) :]

    def close_input(self) -> None:
        """Close its standard input, on which it leaves."""
        with contextlib.suppress(OSError):
            self._input.close()

    def send_signal(self, number: int) -> None:
        """Send a signal to the process, unless it has ended."""
        if not self._has_ended:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.pid, number)

    def wait(self) -> int:
        """Wait until it has ended, and return its exit status, or the number of the signal that killed it, negative."""
        status = self._popen.wait()
        assert status is not None
        if status == LOST_EXIT_STATUS:  # or it lives on without its server, and another one is to take its place
            self.send_signal(signal.SIGKILL)
        self._has_ended = True
        self._popen.close()
        return status


def _run(name: str, function: Callable[[], object], reader: Connection, writer: Connection) -> None:
    """Become a process as if started by itself, and call the function."""
    with reader, writer:
        os.dup2(reader.fileno(), 0)
        os.dup2(writer.fileno(), 2)
    sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115 - as long as the process
    os.setsid()
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    with contextlib.suppress(OSError), open("/proc/self/comm", "w", encoding="ascii") as shown:
        shown.write(name)
    gc.freeze()  # to look through what the server has loaded would copy it
    function()
