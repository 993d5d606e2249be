"""A TCP line that can be made bad: everything between a client and a port passes through it."""

import contextlib
import socket
import threading


class Proxy:
    """Forwards connections to a port of this machine, or to the socket at a path; use it as a context manager.

    Attributes:
        port: where clients connect.
    """

    def __init__(self, to: int | str) -> None:
        self._to = to
        self._server = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._server.getsockname()[1])
        self._flows = threading.Event()
        self._flows.set()
        self._lock = threading.Lock()
        self._sockets: list[socket.socket] = []
        self._closed = False
        self._cut = False
        self._acceptor = threading.Thread(target=self._accept, daemon=True)
        self._acceptor.start()

    def __enter__(self) -> "Proxy":
        return self

    def __exit__(self, *_: object) -> None:
        self._closed = True
        self._server.shutdown(socket.SHUT_RDWR)  # wakes the acceptor, who may be about to connect
        self._acceptor.join()
        self._server.close()
        self.drop()
        self.go_on()

    def stall(self) -> None:
        """Let nothing through, as a switch that hangs."""
        self._flows.clear()

    def drop(self, *, cut: bool = False) -> None:
        """Break every connection, with all that is under way; with `cut` refuse new ones until `go_on`."""
        with self._lock:
            self._cut = cut
            broken, self._sockets = self._sockets, []
        for each in broken:
            with contextlib.suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
            each.close()

    def go_on(self) -> None:
        """Let everything through again."""
        self._cut = False
        self._flows.set()

    def _accept(self) -> None:
        while not self._closed:
            try:
                client, _ = self._server.accept()
            except OSError:
                return
            if self._cut:
                client.close()
                continue
            try:
                server = self._connect()
            except OSError:
                client.close()
                continue
            with self._lock:
                if is_open := not self._cut:  # it may have been cut meanwhile
                    self._sockets += [client, server]
            if not is_open:
                client.close()
                server.close()
                continue
            for one, other in ((client, server), (server, client)):
                threading.Thread(target=self._pump, args=(one, other), daemon=True).start()

    def _connect(self) -> socket.socket:
        if isinstance(self._to, int):
            return socket.create_connection(("127.0.0.1", self._to))
        server = socket.socket(socket.AF_UNIX)
        server.connect(self._to)
        return server

    def _pump(self, one: socket.socket, other: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while content := one.recv(65536):
                self._flows.wait()
                other.sendall(content)
        for each in (one, other):
            with contextlib.suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
