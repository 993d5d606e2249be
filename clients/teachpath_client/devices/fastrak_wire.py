"""The bytes of a Polhemus 3SPACE FASTRAK: commands, data records in binary and ASCII, the status record.

Commands are ASCII; those with parameters end with a carriage return (<>), the others are one letter.

    C c      continuous output on, off            P         one record of each active station
    F f      ASCII, binary output                 U u       inches, centimetres
    ln,s<>   station n off (s=0) or on (s=1)      Hn,x,y,z<> hemisphere: direction of its zenith from the transmitter
    On,i,..<> items of station n's record         S         status record

The data record with the output list `On,2,11,1` (position, quaternion, carriage return and line feed):

    byte                        binary                          ASCII
    record type                 0        "0"                    0        "0"
    station                     1        "1" to "4"             1        "1" to "4"
    error                       2        blank, or a letter     2        blank, or a letter
    x, y, z [inch or cm]        3-14     3 floats               3-23     3 fields of 7, Sxxx.xx
    quaternion w, x, y, z       15-30    4 floats               24-51    4 fields of 7, Sx.xxxx
    carriage return, line feed  31, 32                          52, 53

Floats are IEEE 754 of 32 bits, least significant byte first. S is a sign or a blank.

The status record has 55 bytes: "2", the station, "S", three hexadecimal digits of flags, 47 more characters, carriage
return and line feed. Of the flags bit 0 says binary, bit 1 centimetres, bit 3 continuous.

Sources. *3SPACE FASTRAK User Manual*, OPM00PI002 Rev. G, Polhemus 2012: commands (C, f, H, l, O, S), the ASCII record
with its field formats, the byte order, the status record and its flags. VRPN (`vrpn_Tracker_Fastrak`): `u`, `U`, `F`,
`c`, `P`, the quaternion's order, 55 bytes of status, letters as errors. VRUI (`PolhemusFastrak`): item 1 in binary
records, and that carriage return, line feed, "0", station, error are what to synchronise on. VESS (`vsFastrak`): item 1
takes two bytes in binary records. *Assumed*: that the status record is ASCII in binary mode too (VRPN relies on it),
and that ASCII fields may be padded with blanks as well as with zeros.
"""

from __future__ import annotations

import math
import re
import struct
from dataclasses import dataclass

from teachpath_client.reading import Quaternion, Vector

STATIONS = range(1, 5)
ITEMS = "2,11,1"
BINARY = struct.Struct("<3c7f2s")
END = b"\r\n"
FIELD = rb"( *[+-]? *\d*\.\d+)"
ASCII_SIZE = 3 + 7 * 7 + len(END)
ASCII = re.compile(rb"0([1-4])([ A-Za-z])((?s:.{21}))((?s:.{28}))")
STATUS = re.compile(rb"2[ 0-9]S([0-9A-Fa-f]{3})[ -~]{47}\r\n")
STATUS_SIZE = 55
MAX_POSITION = 1000.0  # inch or cm: what the ASCII record cannot show, no device measures
LENGTH_TOLERANCE = 0.01  # by how much the length of a quaternion may differ from 1


@dataclass(frozen=True, slots=True)
class Pose:
    """One data record: position in the unit of the wire, unit quaternion w, x, y, z."""

    station: int
    error: str  # " ": none
    position: Vector
    orientation: Quaternion


class BinaryParser:
    """Finds binary records; what is none is skipped byte by byte, so that a whole record is never lost to noise."""

    def __init__(self) -> None:
        self._buffer = bytearray()

    def feed(self, content: bytes) -> list[tuple[Pose, int]]:
        """Take bytes; return the records that they complete, each with the number of bytes that came after it."""
        self._buffer += content
        found, at = [], 0
        while (at := self._buffer.find(b"0", at)) >= 0 and len(self._buffer) - at >= BINARY.size:
            pose = _read_binary(self._buffer[at : at + BINARY.size])
            if pose is None:
                at += 1
                continue
            at += BINARY.size
            found.append((pose, len(self._buffer) - at))
        del self._buffer[: len(self._buffer) if at < 0 else at]
        return found


class AsciiParser:
    """Finds ASCII records: the end of each line, so that what was torn before it does no harm."""

    def __init__(self) -> None:
        self._buffer = bytearray()

    def feed(self, content: bytes) -> list[tuple[Pose, int]]:
        """Take bytes; return the records that they complete, each with the number of bytes that came after it."""
        self._buffer += content
        found, at = [], 0
        while (end := self._buffer.find(END, at)) >= 0:
            pose = _read_ascii(bytes(self._buffer[at:end][-(ASCII_SIZE - len(END)) :]))
            at = end + len(END)
            if pose is not None:
                found.append((pose, len(self._buffer) - at))
        del self._buffer[: max(at, len(self._buffer) - ASCII_SIZE)]
        return found


def _read_binary(record: bytes | bytearray) -> Pose | None:
    kind, station, error, *values, end = BINARY.unpack(record)
    if kind != b"0" or end != END or station not in (b"1", b"2", b"3", b"4"):
        return None
    return _pose(station, error, values)


def _read_ascii(line: bytes) -> Pose | None:
    match = ASCII.fullmatch(line)
    if match is None:
        return None
    station, error, position, orientation = match.groups()
    values = []
    for text in (position, orientation):
        for i in range(0, len(text), 7):
            field = re.fullmatch(FIELD, text[i : i + 7])
            if field is None:
                return None
            values.append(float(field[1].replace(b" ", b"")))
    return _pose(station, error, values)


def _pose(station: bytes, error: bytes, values: list[float]) -> Pose | None:
    if not (error == b" " or error.isalpha()) or not all(map(math.isfinite, values)):
        return None
    x, y, z, *quaternion = values
    length = math.hypot(*quaternion)
    if max(abs(x), abs(y), abs(z)) > MAX_POSITION or abs(length - 1.0) > LENGTH_TOLERANCE:
        return None
    a, b, c, d = (value / length for value in quaternion)
    return Pose(int(station), error.decode(), (x, y, z), (a, b, c, d))


def write_record(pose: Pose, *, binary: bool) -> bytes:
    """Return the bytes of a data record, as the device sends it."""
    head = f"0{pose.station}{pose.error}".encode()
    if binary:
        return head + struct.pack("<7f", *pose.position, *pose.orientation) + END
    position = "".join(f"{value:7.2f}" for value in pose.position)
    return head + (position + "".join(f"{value:7.4f}" for value in pose.orientation)).encode() + END


def read_status(content: bytes) -> tuple[bool, bool] | None:
    """Return whether the status record in `content` says binary, and centimetres; None when there is none."""
    matches = STATUS.findall(content)
    if not matches:
        return None
    flags = int(matches[-1], 16)
    return bool(flags & 1), bool(flags & 2)


def write_status(station: int, *, binary: bool, centimetres: bool, continuous: bool) -> bytes:
    """Return the bytes of a status record, as the device sends it."""
    flags = 0x3F0 | binary | centimetres << 1 | continuous << 3
    return f"2{station}S{flags:03X}".encode().ljust(STATUS_SIZE - len(END)) + END
