"""What a process of a pool sends to the service, by a pipe of its own.

A process may be killed in the middle of what it sends. Nothing that others use is locked then: its pipe has ended, and
the next process has another one.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import Any

from teachpath.logs import log_as_json


class ProcessPipe:
    """What one process sends, passed on until it has ended, even in the middle of a message.

    Args:
        name: of the thread that reads it.
        pass_on: called with each message, on that thread.

    Attributes:
        writer: what the process sends to.
    """

    def __init__(self, name: str, pass_on: Callable[[Any], object]) -> None:
        self.writer: Connection
        self._reader, self.writer = Pipe(duplex=False)
        self._pass_on = pass_on
        threading.Thread(target=self._read, name=name, daemon=True).start()

    def leave_writer(self) -> None:
        """Leave writing to the process, which has begun; its end is noticed then."""
        self.writer.close()

    def _read(self) -> None:
        with self._reader, suppress(EOFError, OSError):  # the process has ended
            while True:
                self._pass_on(self._reader.recv())


def send(writer: Connection, message: Any) -> None:
    """Send to the service; where that has ended, this process ends with it."""
    with suppress(OSError):
        writer.send(message)


def log_to_service(writer: Connection, part: str) -> None:
    """Let the log of this process go to the service, as that of a part of the station."""
    log_as_json(lambda line: send(writer, line), part=part)
