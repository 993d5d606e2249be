"""A serial line, read with a timeout: a serial port, a USB adapter or a pseudo-terminal."""

from __future__ import annotations

import errno
import os

from serial import Serial

from teachpath_client.errors import ClientError

BAUD_RATES = (1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400)
WRITE_TIMEOUT = 1.0  # [s] after which a line that takes no bytes counts as lost


class SerialLine:
    """One serial port, 8 data bits, no parity, 1 stop bit, no handshake.

    Every method raises ClientError when the device is not there or goes away. A line can be opened again after it
    was closed.
    """

    def __init__(self, path: str, baud: int = 115200) -> None:
        if baud not in BAUD_RATES:
            known = ", ".join(map(str, BAUD_RATES))
            raise ClientError(f"{baud} baud is no speed of a serial line; there are {known}")
        self.path: str = path
        self.baud: int = baud
        self._port = Serial()

    def open(self) -> None:
        """Open the port for this process alone, with nothing of old in it."""
        self.close()
        try:
            # Two readers of one line would each get half of every record.
            self._port = Serial(self.path, self.baud, exclusive=True, write_timeout=WRITE_TIMEOUT)
            self._port.reset_output_buffer()
        except Exception as error:  # termios.error too, which pyserial lets pass: Windows has no such name
            self.close()
            number = getattr(error, "errno", None)
            if number in (errno.EAGAIN, errno.EWOULDBLOCK):
                raise ClientError(f"another program is using {self.path}; end it first") from None
            reason = os.strerror(number) if number else error
            raise ClientError(
                f"cannot open {self.path} as a serial line: {reason}; is the device plugged in?"
            ) from None

    def close(self) -> None:
        """Let go of the port; a second call does nothing."""
        self._port.close()

    def read(self, timeout: float) -> bytes:
        """Return the bytes that came, as soon as there are any; none after `timeout` [s]."""
        try:
            if self._port.timeout != timeout:  # setting it configures the port anew
                self._port.timeout = timeout
            first: bytes = self._port.read(1)
            return first + self._port.read(self._port.in_waiting) if first else b""
        except (OSError, ValueError) as error:
            raise self._lost(error) from None

    def write(self, content: bytes) -> None:
        """Send bytes."""
        try:
            self._port.write(content)
        except (OSError, ValueError) as error:
            raise self._lost(error) from None

    def _lost(self, reason: object) -> ClientError:
        return ClientError(f"the device at {self.path} is gone: {reason}")
