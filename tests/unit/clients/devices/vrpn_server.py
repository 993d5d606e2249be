"""A server of VRPN as an emulator that misbehaves: it tears messages, breaks off, and sends what nobody asked for."""

import socket
import struct
import threading
from contextlib import suppress
from types import TracebackType

COOKIE = b"vrpn: ver. 07.35  0".ljust(24, b"\0")
SENDERS = {0: "table", 1: "hand", 2: "trigger"}
KINDS = {0: "vrpn_Base ping_message", 1: "vrpn_Tracker Pos_Quat", 2: "vrpn_Button Change"}


def message(sender: int, kind: int, body: bytes, stamp_ns: int = 0) -> bytes:
    seconds, rest = divmod(stamp_ns, 1_000_000_000)
    head = struct.pack(">iIIiiI", 24 + len(body), seconds, rest // 1000, sender, kind, 7)
    return head + body + bytes(-len(body) % 8)


def descriptions() -> bytes:
    said = b""
    for kind, names in ((-1, SENDERS), (-2, KINDS)):
        for number, name in names.items():
            said += message(number, kind, struct.pack(">I", len(name) + 1) + name.encode() + b"\0")
    return said


def pose(stamp_ns: int, place: tuple[float, float, float], *, sender: int = 1, sensor: int = 0) -> bytes:
    return message(sender, 1, struct.pack(">ii3d4d", sensor, 0, *place, 0.0, 0.0, 0.0, 1.0), stamp_ns)


def press(state: int, *, button: int = 0) -> bytes:
    return message(2, 2, struct.pack(">ii", button, state))


class VrpnServer:
    """Serves one client after another; use it as a context manager.

    Args:
        cookie: that it sends.

    Attributes:
        address: HOST:PORT.
        connections: how many clients have been greeted.
    """

    def __init__(self, cookie: bytes = COOKIE) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._listener.getsockname()[1]}"
        self.connections = 0
        self._cookie = cookie
        self._client: socket.socket | None = None
        self._thread = threading.Thread(target=self._accept, daemon=True)

    def __enter__(self) -> "VrpnServer":
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        self._thread.join()
        self.break_off()

    def send(self, content: bytes) -> bool:
        """Send bytes to the newest client; tell whether there is one that takes them."""
        client = self._client
        try:
            if client is not None:
                client.sendall(content)
        except OSError:
            return False
        return client is not None

    def break_off(self) -> None:
        """Close the connection with the newest client."""
        client, self._client = self._client, None
        if client is not None:
            client.close()

    def _accept(self) -> None:
        while True:
            try:
                client, _ = self._listener.accept()
            except OSError:
                return
            with suppress(OSError):  # it may have gone again
                client.sendall(self._cookie + descriptions())
            self.break_off()
            self._client = client
            self.connections += 1
