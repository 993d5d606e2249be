"""An S3 server for tests, in memory and on a real socket: what the station uses of the protocol, and its faults.

It checks signatures, check sums and preconditions as the servers of object storage do.
"""

from __future__ import annotations

import base64
import hmac
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from hashlib import md5, sha256
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qsl, quote, unquote, urlsplit
from xml.sax.saxutils import escape

KEY_ID, SECRET = "station", "a secret of the station"
BUCKET = "recordings"
PIECE = 4096  # bytes that a slow line carries at a time


class ObjectServer:
    """The server; what it holds outlives a stop.

    Attributes:
        objects: content by key.
        capacity: bytes for which the bucket has room.
        pause: [s] after each piece of an upload, as on a slow line.
        lines: connections of clients.
    """

    def __init__(self) -> None:
        self.objects: dict[str, bytes] = {}
        self.capacity, self.pause = 1 << 30, 0.0
        self.lines: set[socket.socket] = set()
        self._port = 0
        self._server: ThreadingHTTPServer | None = None

    def start(self) -> None:
        """Listen, on the same port as before."""
        self._server = ThreadingHTTPServer(("127.0.0.1", self._port), _Handler)
        self._server.daemon_threads = True
        self._server.block_on_close = False
        self._server.held = self  # type: ignore[attr-defined]
        self._port = self._server.server_address[1]
        threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True).start()

    def stop(self) -> None:
        """Listen no more, and hang up."""
        if self._server is not None:
            self._server.shutdown()
            self._server.server_close()
            self._server = None
        for line in tuple(self.lines):
            with suppress(OSError):  # the other side was faster
                line.shutdown(socket.SHUT_RDWR)

    @property
    def environment(self) -> dict[str, str]:
        """The variables by which clients find it."""
        return {
            "AWS_ACCESS_KEY_ID": KEY_ID,
            "AWS_SECRET_ACCESS_KEY": SECRET,
            "AWS_ENDPOINT_URL": f"http://127.0.0.1:{self._port}",
            "AWS_REGION": "us-east-1",
        }


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    wbufsize = -1  # head and content of an answer in one packet

    def setup(self) -> None:
        super().setup()
        self.held.lines.add(self.connection)

    def finish(self) -> None:
        self.held.lines.discard(self.connection)
        with suppress(OSError):  # a client that was killed, or hung up on, reads no answer
            super().finish()

    @property
    def held(self) -> ObjectServer:
        held: ObjectServer = self.server.held  # type: ignore[attr-defined]
        return held

    def log_message(self, *_: Any) -> None:
        pass

    def do_PUT(self) -> None:
        content = b"".join(self._pieces(int(self.headers.get("Content-Length", 0))))
        if not self._is_allowed(content):
            return
        stated = self.headers.get("x-amz-checksum-sha256")
        if stated and base64.b64decode(stated) != sha256(content).digest():
            self._refuse(400, "BadDigest")
        elif self.headers.get("If-None-Match") == "*" and self._key in self.held.objects:
            self._refuse(412, "PreconditionFailed")
        elif sum(map(len, self.held.objects.values())) + len(content) > self.held.capacity:
            self._refuse(507, "XMinioStorageFull")
        else:
            self.held.objects[self._key] = content
            self._answer(200, b"", ETag=f'"{md5(content).hexdigest()}"')

    def do_GET(self) -> None:
        if not self._is_allowed():
            return
        if not self._key:
            self._answer(200, self._listed().encode())
        elif (content := self.held.objects.get(self._key)) is None:
            self._refuse(404, "NoSuchKey")
        else:
            self._answer(200, content, **_facts(content))

    @property
    def _key(self) -> str:
        return unquote(urlsplit(self.path).path).removeprefix(f"/{BUCKET}").removeprefix("/")

    def _pieces(self, size: int) -> Iterator[bytes]:
        for place in range(0, size, PIECE):
            yield self.rfile.read(min(PIECE, size - place))
            if self.held.pause:
                time.sleep(self.held.pause)

    def _listed(self) -> str:
        prefix = dict(parse_qsl(urlsplit(self.path).query)).get("prefix", "")
        entries = "".join(
            f"<Contents><Key>{escape(key)}</Key><Size>{len(content)}</Size><ETag>e</ETag>"
            "<LastModified>2026-01-01T00:00:00.000Z</LastModified></Contents>"
            for key, content in sorted(self.held.objects.items())
            if key.startswith(prefix)
        )
        return f"<ListBucketResult><IsTruncated>false</IsTruncated>{entries}</ListBucketResult>"

    def _is_allowed(self, content: bytes = b"") -> bool:
        if not unquote(urlsplit(self.path).path).startswith(f"/{BUCKET}"):
            self._refuse(404, "NoSuchBucket")
        elif KEY_ID not in self.headers.get("Authorization", ""):
            self._refuse(403, "InvalidAccessKeyId")
        elif not self._is_signed(content):
            self._refuse(403, "SignatureDoesNotMatch")
        else:
            return True
        return False

    def _is_signed(self, content: bytes) -> bool:
        """Compute the signature of the request anew (AWS signature version 4)."""
        stated = dict(part.strip().split("=", 1) for part in self.headers["Authorization"].partition(" ")[2].split(","))
        names, scope = stated["SignedHeaders"].split(";"), stated["Credential"].split("/")[1:]
        hashed = self.headers["x-amz-content-sha256"]
        url = urlsplit(self.path)
        query = sorted((quote(k, "-_.~"), quote(v, "-_.~")) for k, v in parse_qsl(url.query, keep_blank_values=True))
        request = [self.command, url.path, "&".join(f"{key}={value}" for key, value in query)]
        request += [f"{name}:{' '.join((self.headers.get(name) or '').split())}" for name in names]
        request += ["", ";".join(names), hashed]
        told = ["AWS4-HMAC-SHA256", self.headers["x-amz-date"], "/".join(scope), _hash("\n".join(request).encode())]
        key = f"AWS4{SECRET}".encode()
        for word in scope:
            key = hmac.digest(key, word.encode(), "sha256")
        signed = hmac.digest(key, "\n".join(told).encode(), "sha256").hex()
        return hashed in ("UNSIGNED-PAYLOAD", _hash(content)) and hmac.compare_digest(signed, stated["Signature"])

    def _refuse(self, status: int, code: str) -> None:
        self._answer(status, f"<Error><Code>{code}</Code><Message>{code}</Message></Error>".encode())

    def _answer(self, status: int, content: bytes, **headers: str) -> None:
        self.send_response(status)
        for name, value in {"Content-Length": str(len(content)), **headers}.items():
            self.send_header(name.replace("_", "-"), value)
        self.end_headers()
        self.wfile.write(content)


def _hash(content: bytes) -> str:
    return sha256(content).hexdigest()


def _facts(content: bytes) -> dict[str, str]:
    return {"ETag": f'"{md5(content).hexdigest()}"', "Last_Modified": "Thu, 01 Jan 2026 00:00:00 GMT"}


@contextmanager
def serving_objects() -> Iterator[ObjectServer]:
    """Start a server, and stop it."""
    server = ObjectServer()
    server.start()
    try:
        yield server
    finally:
        server.stop()
