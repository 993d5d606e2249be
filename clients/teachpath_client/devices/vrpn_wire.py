"""The messages of VRPN (Virtual-Reality Peripheral Network, version 7), as far as poses and buttons go.

After the public description of the protocol and VRPN's own sources (`vrpn_Connection.C`, `vrpn_Tracker.C`): both sides
send a cookie of 24 bytes; then every message has a header of 24 bytes and a body that is filled up to a multiple of 8.
All numbers are big-endian. Senders and kinds of messages have numbers that descriptions (kinds -1 and -2) give names.
Quaternions are x, y, z, w, as in `quatlib.h`.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Final

from teachpath_client.errors import ClientError
from teachpath_client.reading import Quaternion, Vector

PORT: Final = 3883
COOKIE_BEGIN: Final = b"vrpn: ver. 07."
COOKIE: Final = b"vrpn: ver. 07.35  0".ljust(24, b"\0")  # 0: nothing is to be logged at the other end
HEADER: Final = struct.Struct(">iIIiiI")  # length without filling, seconds, microseconds, sender, kind, number
SENDER, KIND = -1, -2  # kinds of messages that describe
POSE, BUTTON = "vrpn_Tracker Pos_Quat", "vrpn_Button Change"
POSE_BODY: Final = struct.Struct(">ii3d4d")  # sensor, filling, position, quaternion
BUTTON_BODY: Final = struct.Struct(">ii")  # number, state
ALIGN: Final = 8
MAX_LENGTH: Final = 1_000_000  # bytes of a message; a pose has 88
MAX_NAMES: Final = 10_000


@dataclass(frozen=True, slots=True)
class Pose:
    """Where a sensor is.

    Attributes:
        stamp_ns: of the server's clock [ns since the Unix epoch]; 0: it has none.
        position: [m].
        orientation: w, x, y, z.
    """

    stamp_ns: int
    position: Vector
    orientation: Quaternion


@dataclass(frozen=True, slots=True)
class Button:
    """Whether a button is pressed."""

    pressed: bool


class VrpnParser:
    """Finds the poses of one sensor, and the presses of one button, in a stream of messages.

    Args:
        tracker: name of the sender of poses.
        sensor: its number.
        device: name of the sender of buttons; empty: none.
        button: its number.

    Attributes:
        trackers: names of those that sent poses, with the numbers of their sensors.
    """

    def __init__(self, tracker: str, sensor: int, device: str = "", button: int = 0) -> None:
        self._tracker, self._sensor, self._device, self._button = tracker, sensor, device, button
        self._buffer = bytearray()
        self._names: dict[int, dict[int, str]] = {SENDER: {}, KIND: {}}
        self.trackers: set[tuple[str, int]] = set()

    def feed(self, content: bytes) -> list[tuple[Pose | Button, int]]:
        """Take bytes; return the records that they complete, each with the number of bytes that came after it.

        Raises:
            ClientError: they are no messages of VRPN.
        """
        self._buffer += content
        found: list[tuple[Pose | Button, int]] = []
        while len(self._buffer) >= HEADER.size:
            length, seconds, microseconds, sender, kind, _ = HEADER.unpack_from(self._buffer)
            if not HEADER.size <= length <= MAX_LENGTH:
                raise ClientError(f"a message of VRPN says that it has {length} bytes; what comes is none")
            size = length + -length % ALIGN
            if len(self._buffer) < size:
                break
            body = bytes(self._buffer[HEADER.size : length])
            del self._buffer[:size]
            record = self._record(sender, kind, body, (seconds * 1_000_000 + microseconds) * 1000)
            if record is not None:
                found.append((record, len(self._buffer)))
        return found

    def _record(self, sender: int, kind: int, body: bytes, stamp_ns: int) -> Pose | Button | None:
        if kind in self._names:
            self._describe(self._names[kind], sender, body)
            return None
        called = self._names[SENDER].get(sender, ""), self._names[KIND].get(kind, "")
        if called[1] == POSE and len(body) == POSE_BODY.size:
            sensor, _, px, py, pz, x, y, z, w = POSE_BODY.unpack(body)
            if len(self.trackers) < MAX_NAMES:
                self.trackers.add((called[0], sensor))
            wanted = (called[0], sensor) == (self._tracker, self._sensor)
            return Pose(stamp_ns, (px, py, pz), (w, x, y, z)) if wanted else None
        if called == (self._device, BUTTON) and self._device and len(body) == BUTTON_BODY.size:
            number, state = BUTTON_BODY.unpack(body)
            return Button(state != 0) if number == self._button else None
        return None

    @staticmethod
    def _describe(names: dict[int, str], number: int, body: bytes) -> None:
        """Keep the name of a sender or of a kind of messages: its length, then the name and a zero."""
        if len(names) >= MAX_NAMES and number not in names:
            raise ClientError(f"over {MAX_NAMES} names, the limit")
        names[number] = body[4:].partition(b"\0")[0].decode(errors="replace")
