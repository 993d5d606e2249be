"""A server of NatNet as an emulator that misbehaves: it tears datagrams, doubles them, and speaks old versions."""

import socket
import struct
import threading
from collections import deque
from types import TracebackType

NAMES = {"hand": 7, "table": 3}
Place = tuple[float, float, float]


def datagram(kind: int, body: bytes) -> bytes:
    return struct.pack("<HH", kind, len(body)) + body


def section(entries: list[bytes], sized: bool) -> bytes:
    content = b"".join(entries)
    return struct.pack("<i", len(entries)) + (struct.pack("<i", len(content)) if sized else b"") + content


def rigid_body(number: int, place: Place, *, tracked: bool = True) -> bytes:
    return struct.pack("<i3f4ffH", number, *place, 0.0, 0.0, 0.0, 1.0, 0.001, int(tracked))


def frame(seconds: float, bodies: list[bytes], version: tuple[int, int] = (4, 1)) -> bytes:
    """Return a frame with two sets of markers, a marker of no set, a skeleton's section and what ends it."""
    sized = version >= (4, 1)
    markers = [name + b"\0" + struct.pack("<i3f", 1, 1.0, 2.0, 3.0) for name in (b"hand", b"all")]
    body = struct.pack("<i", 1) + section(markers, sized) + section([struct.pack("<3f", 1.0, 2.0, 3.0)], sized)
    body += section(bodies, sized)
    for _ in range(5 if sized else 4):  # skeletons, assets from 4.1 on, labelled markers, force plates, devices
        body += section([], sized)
    body += struct.pack("<IIdQQQ", 0, 0, seconds, 1, 2, 3) + (struct.pack("<II", 4, 5) if sized else b"")
    return datagram(7, body + struct.pack("<Hi", 0, 0))


def descriptions(version: tuple[int, int] = (4, 1)) -> bytes:
    """Return what a server has: a set of markers, two rigid bodies and a camera."""
    described = [(0, b"all\0" + struct.pack("<i", 2) + b"a\0b\0")]
    for name, number in NAMES.items():
        marker = struct.pack("<3fi", 1.0, 2.0, 3.0, 0) + (b"m1\0" if version >= (4, 0) else b"")
        described.append((1, name.encode() + b"\0" + struct.pack("<ii3fi", number, -1, 0.0, 0.0, 0.0, 1) + marker))
    described.append((5, b"camera\0" + struct.pack("<7f", *[0.0] * 7)))
    body = struct.pack("<i", len(described))
    for kind, content in described:
        body += struct.pack("<i", kind) + (struct.pack("<i", len(content)) if version >= (4, 1) else b"") + content
    return datagram(5, body)


def server_info(version: tuple[int, int] = (4, 1)) -> bytes:
    return datagram(1, b"Motive".ljust(256, b"\0") + bytes([3, 1, 0, 0, *version, 0, 0]) + bytes(15))


class NatNetServer:
    """Answers one client after another; use it as a context manager.

    Args:
        version: of its stream.

    Attributes:
        address: HOST:PORT.
        connections: how often it was asked who it is.
        kept_alive: how often it was told that somebody listens.
        swallow: how many of the next questions it does not answer.
    """

    def __init__(self, version: tuple[int, int] = (4, 1)) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._socket.getsockname()[1]}"
        self.connections = self.kept_alive = self.swallow = 0
        self._version, self._client = version, deque[tuple[str, int]](maxlen=1)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._answer, daemon=True)

    def __enter__(self) -> "NatNetServer":
        self._socket.settimeout(0.05)
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over.set()
        self._thread.join()
        self._socket.close()

    def send(self, content: bytes) -> bool:
        """Send a datagram to the newest client; tell whether there is one."""
        for client in tuple(self._client):
            self._socket.sendto(content, client)
        return bool(self._client)

    def _answer(self) -> None:
        answers = {0: server_info(self._version), 4: descriptions(self._version)}
        while not self._over.is_set():
            try:
                content, client = self._socket.recvfrom(65_536)
            except (TimeoutError, ConnectionError):  # some systems say here that a client has gone
                continue
            (kind,) = struct.unpack_from("<H", content)
            if kind in answers and self.swallow:
                self.swallow -= 1
                continue
            self._client.append(client)
            self.connections += kind == 0
            self.kept_alive += kind == 10
            if kind in answers:
                self._socket.sendto(answers[kind], client)
