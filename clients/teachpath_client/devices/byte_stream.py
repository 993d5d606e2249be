"""Where bytes of a device come from: a serial line, or a connection over the network."""

from __future__ import annotations

import socket
from abc import ABC, abstractmethod
from typing import Final, Protocol

from teachpath_client.errors import ClientError

READ_SIZE: Final = 65_536  # bytes
OPEN_TIMEOUT: Final = 5.0  # [s]
PORTS: Final = range(1, 65_536)
SHORTEST_WAIT: Final = 1e-3  # [s]; a timeout of 0 would mean that nobody waits for the first byte either


class ByteStream(Protocol):
    """A line that can be opened again after it was closed; methods raise ClientError when the device is not there.

    Attributes:
        path: names it, for people.
        baud: bits that go over it in a second.
    """

    path: str
    baud: int

    def open(self) -> None:
        """Open it, with nothing of old in it."""

    def close(self) -> None:
        """Let go of it; a second call does nothing."""

    def read(self, timeout: float) -> bytes:
        """Return the bytes that came, as soon as there are any; none after `timeout` [s]."""

    def write(self, content: bytes) -> None:
        """Send bytes."""


def split_address(option: str, text: str, port: int) -> tuple[str, int]:
    """Return host and port of HOST or HOST:PORT; `port` where none is said. Raises ClientError that names `option`."""
    host, mark, said = text.rpartition(":")
    if not mark:
        return text, port
    if not said.isdecimal() or int(said) not in PORTS:
        raise ClientError(f"{option}={text}: {said!r} is no port, 1 to {PORTS[-1]}")
    return host, int(said)


class _SocketStream(ABC):
    """A socket that is connected with one address.

    Args:
        host: name or address.
        port: number.
    """

    def __init__(self, host: str, port: int) -> None:
        self.path: str = f"{host}:{port}"
        self.baud: int = 1_000_000_000
        self._address = host, port
        self._socket: socket.socket | None = None

    def open(self) -> None:
        """Connect."""
        self.close()
        try:
            self._socket = self._connect()
        except (OSError, OverflowError) as error:  # of a port that is none
            raise ClientError(f"nobody answers at {self.path}: {error}") from None

    def close(self) -> None:
        """Disconnect; a second call does nothing."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def read(self, timeout: float) -> bytes:
        """Return the bytes that came, as soon as there are any; none after `timeout` [s]."""
        connection = self._connected()
        try:
            connection.settimeout(max(timeout, SHORTEST_WAIT))
            content = connection.recv(READ_SIZE)
        except TimeoutError:
            return b""
        except OSError as error:
            raise ClientError(f"the connection with {self.path} is gone: {error}") from None
        self._check(content)
        return content

    def write(self, content: bytes) -> None:
        """Send bytes."""
        connection = self._connected()
        try:
            connection.settimeout(OPEN_TIMEOUT)
            connection.sendall(content)
        except OSError as error:
            raise ClientError(f"the connection with {self.path} is gone: {error}") from None

    @abstractmethod
    def _connect(self) -> socket.socket:
        """Return a connected socket; raises OSError."""

    @abstractmethod
    def _check(self, content: bytes) -> None:
        """Raise ClientError when what came says that the other end has closed."""

    def _connected(self) -> socket.socket:
        if self._socket is None:
            raise ClientError(f"there is no connection with {self.path}")
        return self._socket


class TcpStream(_SocketStream):
    """A TCP connection."""

    def _connect(self) -> socket.socket:
        connection = socket.create_connection(self._address, OPEN_TIMEOUT)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return connection

    def _check(self, content: bytes) -> None:
        if not content:
            raise ClientError(f"{self.path} has closed the connection")


class UdpStream(_SocketStream):
    """Datagrams from one address; each read returns one."""

    def _connect(self) -> socket.socket:
        family, kind, protocol, _, address = socket.getaddrinfo(*self._address, type=socket.SOCK_DGRAM)[0]
        connection = socket.socket(family, kind, protocol)
        try:
            connection.connect(address)
        except OSError:
            connection.close()
            raise
        return connection

    def _check(self, content: bytes) -> None:
        """Do nothing: an empty datagram is one."""
