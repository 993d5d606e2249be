"""A serial line: a tty opened raw, read with a timeout; works for serial ports, USB adapters and ptys alike."""

from __future__ import annotations

import fcntl
import os
import select
import termios
import tty

from teachpath_client.link import ClientError

BAUDS = {
    rate: int(getattr(termios, f"B{rate}")) for rate in (1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400)
}
CHUNK = 4096  # bytes a read takes at most
STUCK = 1.0  # [s] after which a line that takes no bytes counts as lost
INPUT_SPEED, OUTPUT_SPEED = 4, 5  # places in what tcgetattr returns


class SerialLine:
    """One serial port, 8 data bits, no parity, 1 stop bit, no handshake.

    Every method raises ClientError when the device is not there or goes away. A line can be opened again after it
    was closed.
    """

    def __init__(self, path: str, baud: int = 115200) -> None:
        if baud not in BAUDS:
            raise ClientError(f"{baud} baud is no speed of a serial line; there are {', '.join(map(str, BAUDS))}")
        self.path, self.baud = path, baud
        self._fd = -1

    def open(self) -> None:
        """Open the port for this process alone, raw, with nothing of old in it."""
        self.close()
        try:
            self._fd = os.open(self.path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK | os.O_CLOEXEC)
            # Two readers of one line would each get half of every record.
            fcntl.flock(self._fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
            tty.setraw(self._fd)
            attributes = termios.tcgetattr(self._fd)
            attributes[INPUT_SPEED] = attributes[OUTPUT_SPEED] = BAUDS[self.baud]
            control = int(attributes[2]) & ~(termios.CSTOPB | termios.CRTSCTS)
            attributes[2] = control | termios.CLOCAL | termios.CREAD
            termios.tcsetattr(self._fd, termios.TCSANOW, attributes)
            termios.tcflush(self._fd, termios.TCIOFLUSH)
        except BlockingIOError:
            self.close()
            raise ClientError(f"another program is using {self.path}; end it first") from None
        except (OSError, termios.error) as error:
            self.close()
            raise ClientError(f"cannot open {self.path} as a serial line: {error}; is the device plugged in?") from None

    def close(self) -> None:
        """Let go of the port; a second call does nothing."""
        fd, self._fd = self._fd, -1
        if fd >= 0:
            os.close(fd)

    def read(self, timeout: float) -> bytes:
        """Return the bytes that came, as soon as there are any; none after `timeout` [s]."""
        try:
            if not select.select([self._fd], [], [], timeout)[0]:
                return b""
            content = os.read(self._fd, CHUNK)
        except BlockingIOError:
            return b""
        except (OSError, ValueError) as error:
            raise self._lost(error) from None
        if not content:
            raise self._lost("it hung up")
        return content

    def write(self, content: bytes) -> None:
        """Send bytes."""
        while content:
            try:
                if not select.select([], [self._fd], [], STUCK)[1]:
                    raise self._lost(f"it took no bytes for {STUCK:g} s")
                content = content[os.write(self._fd, content) :]
            except BlockingIOError:
                continue
            except (OSError, ValueError) as error:
                raise self._lost(error) from None

    def _lost(self, reason: object) -> ClientError:
        return ClientError(f"the device at {self.path} is gone: {reason}")
