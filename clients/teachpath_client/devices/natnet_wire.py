"""The datagrams of NatNet (OptiTrack Motive), version 3.0 and later, as far as rigid bodies go.

After OptiTrack's public description of the bit stream (NatNet SDK, "PacketClient" and "PythonClient"): a datagram has
a head of 4 bytes, kind and length, and a body; all numbers are little-endian, texts end with a zero. From version 4.1
on every section of a body says how many bytes it has. Quaternions are x, y, z, w.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from enum import IntEnum
from typing import Final

from teachpath_client.errors import ClientError
from teachpath_client.reading import Quaternion, Vector

Version = tuple[int, int]

PORT: Final = 1510  # of commands; in unicast the frames come back to the port that asked
FIRST_VERSION: Final[Version] = (3, 0)  # Motive 2.0, of 2017; frames of earlier ones hold markers within rigid bodies
SIZED_VERSION: Final[Version] = (4, 1)  # sections say their size from here on
HEAD: Final = struct.Struct("<HH")  # kind, bytes of the body
SERVER_INFO: Final = struct.Struct("<256s4B4B")  # name of the application, its version, that of the stream
COUNT: Final = struct.Struct("<i")
RIGID_BODY: Final = struct.Struct("<i3f4ffH")  # number, position, orientation, mean error of markers, flags
IS_TRACKED: Final = 1  # flag of a rigid body
MARKER_SIZE: Final = 12  # bytes of a place
TIME_BEGIN: Final = 8  # bytes of the time code before the time, in what a frame ends with
SUFFIX_SIZE: Final = 46  # bytes that a frame ends with: time code, time, three counters, flags, end
PRECISE_TIME_SIZE: Final = 8  # bytes more of them from version 4.1 on
DESCRIBED_MARKER_SET, DESCRIBED_RIGID_BODY = 0, 1
MAX_COUNT: Final = 100_000  # of anything in a datagram of at most 64 kB


class Kind(IntEnum):
    """What a datagram is."""

    CONNECT = 0
    SERVER_INFO = 1
    REQUEST_DESCRIPTIONS = 4
    DESCRIPTIONS = 5
    FRAME = 7
    KEEP_ALIVE = 10


@dataclass(frozen=True, slots=True)
class RigidBody:
    """Where a rigid body is in one frame.

    Attributes:
        seconds: [s] since the server's program began.
        position: [m].
        orientation: w, x, y, z.
        tracked: whether the cameras see it.
    """

    seconds: float
    position: Vector
    orientation: Quaternion
    tracked: bool


@dataclass(frozen=True, slots=True)
class Frame:
    """The rigid bodies of one frame, by their numbers."""

    number: int
    bodies: dict[int, RigidBody]


def command(kind: Kind) -> bytes:
    """Return a datagram that asks for something, or says that the client is there."""
    body = b"Ping\0" if kind is Kind.CONNECT else b""
    return HEAD.pack(kind, len(body)) + body


def split(datagram: bytes) -> tuple[int, bytes]:
    """Return kind and body; raises ClientError when the datagram is torn or none of NatNet."""
    if len(datagram) < HEAD.size or HEAD.unpack_from(datagram)[1] > len(datagram) - HEAD.size:
        raise ClientError(f"a datagram of {len(datagram)} bytes is none of NatNet, or torn: {datagram[:16]!r}")
    kind, size = HEAD.unpack_from(datagram)
    return kind, datagram[HEAD.size : HEAD.size + size]


def stream_version(body: bytes) -> Version:
    """Return the version of the stream that a server names; raises ClientError when it is too old or not said."""
    if len(body) < SERVER_INFO.size:
        raise ClientError(f"the server describes itself with {len(body)} bytes; NatNet needs {SERVER_INFO.size}")
    name, *numbers = SERVER_INFO.unpack_from(body)
    version = numbers[4], numbers[5]
    if version < FIRST_VERSION:
        called = name.partition(b"\0")[0].decode(errors="replace")
        raise ClientError(
            f"{called or 'the server'} speaks NatNet {version[0]}.{version[1]}; 3.0 is the first that is understood "
            "(Motive 2.0): update it, or let it serve VRPN"
        )
    return version


class Cursor:
    """Reads one body from its begin; raises ClientError where it ends too soon."""

    def __init__(self, body: bytes, version: Version) -> None:
        self._body, self._version, self._at = body, version, 0

    def part(self, size: int) -> Cursor:
        """Return what reads the next `size` bytes, and go on after them."""
        begin = self._at
        self.skip(size)
        return Cursor(self._body[begin : begin + size], self._version)

    def skip(self, size: int) -> None:
        """Go on by `size` bytes."""
        if not 0 <= size <= len(self._body) - self._at:
            raise ClientError(f"a body of NatNet with {len(self._body)} bytes ends before what it says it has")
        self._at += size

    def take(self, kind: struct.Struct) -> tuple[float, ...]:
        """Return the next numbers."""
        begin = self._at
        self.skip(kind.size)
        return kind.unpack_from(self._body, begin)

    def number(self) -> int:
        """Return the next whole number."""
        return int(self.take(COUNT)[0])

    def count(self) -> int:
        """Return how many of something follow."""
        found = self.number()
        if not 0 <= found <= MAX_COUNT:
            raise ClientError(f"a body of NatNet says that {found} things follow; it has {len(self._body)} bytes")
        return found

    def section(self) -> int:
        """Return how many entries the section has that begins here."""
        entries = self.count()
        if self._version >= SIZED_VERSION:
            self.number()
        return entries

    def text(self) -> str:
        """Return the next text."""
        end = self._body.find(b"\0", self._at)
        begin = self._at
        self.skip(end + 1 - begin if end >= 0 else len(self._body) + 1)
        return self._body[begin:end].decode(errors="replace")


def read_frame(body: bytes, version: Version) -> Frame:
    """Return the rigid bodies of a frame; raises ClientError when it is torn."""
    cursor = Cursor(body, version)
    number = cursor.number()
    for _ in range(cursor.section()):  # sets of markers
        cursor.text()
        cursor.skip(cursor.count() * MARKER_SIZE)
    cursor.skip(cursor.section() * MARKER_SIZE)  # markers of no set
    seconds = _seconds(body, version)
    bodies = {}
    for _ in range(cursor.section()):
        body_number, px, py, pz, x, y, z, w, _, flags = cursor.take(RIGID_BODY)
        bodies[int(body_number)] = RigidBody(seconds, (px, py, pz), (w, x, y, z), bool(int(flags) & IS_TRACKED))
    return Frame(number, bodies)


def _seconds(body: bytes, version: Version) -> float:
    """Return the time of a frame, which stands a fixed number of bytes before its end."""
    size = SUFFIX_SIZE + (PRECISE_TIME_SIZE if version >= SIZED_VERSION else 0)
    if len(body) < size:
        raise ClientError(f"a frame of NatNet with {len(body)} bytes has no time")
    return float(struct.unpack_from("<d", body, len(body) - size + TIME_BEGIN)[0])


def rigid_body_names(body: bytes, version: Version) -> dict[str, int]:
    """Return the numbers of the rigid bodies that a server describes, by name; raises ClientError when it is torn.

    Before version 4.1 nothing says how long other things are; what follows the first of them is not read. Servers
    describe sets of markers and rigid bodies first.
    """
    cursor, names = Cursor(body, version), {}
    for _ in range(cursor.count()):
        kind = cursor.number()
        entry = cursor.part(cursor.number()) if version >= SIZED_VERSION else cursor
        if kind == DESCRIBED_RIGID_BODY:
            name = entry.text()
            names[name] = entry.number()
            _skip_rigid_body(entry, version)
        elif kind == DESCRIBED_MARKER_SET:
            entry.text()
            for _ in range(entry.count()):
                entry.text()
        elif entry is cursor:
            break
    return names


def _skip_rigid_body(entry: Cursor, version: Version) -> None:
    """Go over what follows name and number: parent, offset, markers with places, labels and, from 4.0 on, names."""
    entry.skip(COUNT.size + MARKER_SIZE)
    markers = entry.count()
    entry.skip(markers * (MARKER_SIZE + COUNT.size))
    if version >= (4, 0):
        for _ in range(markers):
            entry.text()
