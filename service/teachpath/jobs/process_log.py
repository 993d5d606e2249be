"""What a process of a pool writes down: it stands in the log of the service, under the number of its request."""

from __future__ import annotations

import threading
from contextlib import suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection

from teachpath.logs import log_as_json, relay


class ProcessLog:
    """The lines of one process, which are passed on until it has ended, even in the middle of one.

    Args:
        part: of the station, that the process is.

    Attributes:
        writer: what the process writes to; see `write_to_service`.
    """

    def __init__(self, part: str) -> None:
        self.writer: Connection
        self._lines, self.writer = Pipe(duplex=False)
        threading.Thread(target=self._pass_on, name=f"log of {part}", daemon=True).start()

    def leave_writer(self) -> None:
        """Leave writing to the process, which has begun; its end is noticed then."""
        self.writer.close()

    def _pass_on(self) -> None:
        with self._lines, suppress(EOFError, OSError):  # the process has ended
            while True:
                relay(self._lines.recv_bytes().decode())


def write_to_service(writer: Connection, part: str) -> None:
    """Let the log of this process go to the service, as that of a part of the station."""

    def send(line: str) -> None:
        with suppress(OSError):  # the service has ended, and this process ends with it
            writer.send_bytes(line.encode())

    log_as_json(send, part=part)
