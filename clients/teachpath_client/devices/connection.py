"""A connection with a device that reconnects by itself; its thread reads records and stamps each with its time.

The thread does nothing else, so that neither a slow network nor the other device of a hand shifts a time stamp. The
time of a record is that at which its last byte arrived.
"""

from __future__ import annotations

import logging
import queue
import threading
import time
from collections.abc import Callable
from typing import Generic, Protocol, Self, TypeVar

from teachpath_client.devices.byte_stream import ByteStream
from teachpath_client.errors import ClientError

LOG = logging.getLogger(__name__)

Record = TypeVar("Record")

BITS_PER_BYTE = 10  # on the line for a byte: start, 8 of data, stop
FIRST_RETRY_WAIT, MAX_RETRY_WAIT = 0.05, 2.0  # [s]
MIN_DATE_STEP = 1e-6  # [s] between dates, at least
JOIN_TIMEOUT = 5.0  # [s] for the thread to leave


class Parser(Protocol[Record]):
    """Finds the records in a stream of bytes."""

    def feed(self, content: bytes) -> list[tuple[Record, int]]:
        """Take bytes; return the records that they complete, each with the number of bytes that came after it."""


class DeviceProtocol(Protocol[Record]):
    """The commands that set a device up, poll it and shut it down."""

    def set_up(self, line: ByteStream) -> Parser[Record]:
        """Set the device up and return the parser of what it will send; raises ClientError when it does not answer."""

    def poll(self, line: ByteStream) -> float:
        """Send the commands that are due; return the seconds until the next one is."""

    def shut_down(self, line: ByteStream) -> None:
        """Make the device stop sending."""


class Connection(Generic[Record]):
    """A device on a serial line; use it as a context manager.

    Entering raises ClientError when the device does not answer. After that the connection never gives up: when the
    device is unplugged, or silent for `silence` [s], it is opened and set up anew, later and later up to 2 s apart.

    Args:
        line: where the device is.
        protocol: its commands.
        silence: [s] without a record after which it is set up again, as after a power cycle behind an adapter.
        clock: [s] that never runs back.
    """

    def __init__(
        self,
        line: ByteStream,
        protocol: DeviceProtocol[Record],
        *,
        silence: float,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._line, self._protocol, self._silence, self._clock = line, protocol, silence, clock
        self._records: queue.SimpleQueue[tuple[float, Record]] = queue.SimpleQueue()
        self._first: queue.SimpleQueue[ClientError | None] = queue.SimpleQueue()
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"read {line.path}", daemon=True)
        self._last = float("-inf")

    def __enter__(self) -> Self:
        self._thread.start()
        if (error := self._first.get()) is not None:
            self._thread.join(JOIN_TIMEOUT)
            raise error
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join(JOIN_TIMEOUT)

    def next_record(self, timeout: float) -> tuple[float, Record] | None:
        """Return the time [s] on `clock` and the next record; None after `timeout` [s]."""
        try:
            return self._records.get(timeout=timeout) if timeout > 0 else self._records.get_nowait()
        except queue.Empty:
            return None

    def _run(self) -> None:
        wait, answered = FIRST_RETRY_WAIT, False
        while not self._over.is_set():
            try:
                self._line.open()
                parser = self._protocol.set_up(self._line)
                wait = FIRST_RETRY_WAIT
                if answered:
                    LOG.warning("the device at %s answers again", self._line.path)
                else:
                    self._first.put(None)
                answered = True
                self._read(parser)
                self._protocol.shut_down(self._line)
            except ClientError as error:
                if wait == FIRST_RETRY_WAIT and answered:
                    LOG.warning("%s; trying again until it is back", error)
                if not answered:
                    self._first.put(error)
                    return
            finally:
                self._line.close()
            self._over.wait(wait)
            wait = min(2 * wait, MAX_RETRY_WAIT)

    def _read(self, parser: Parser[Record]) -> None:
        heard = self._clock()
        while not self._over.is_set():
            if self._clock() - heard > self._silence:
                raise ClientError(f"the device at {self._line.path} was silent for {self._silence:g} s")
            content = self._line.read(self._protocol.poll(self._line))
            now = self._clock()
            for record, after in parser.feed(content):
                heard = now
                self._last = max(now - after * BITS_PER_BYTE / self._line.baud, self._last + MIN_DATE_STEP)
                self._records.put((self._last, record))
