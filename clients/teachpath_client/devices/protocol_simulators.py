"""FASTRAK and CyberGlove in memory: simulators that speak their protocols, bytes in and bytes out."""

from __future__ import annotations

import re
from typing import Protocol

from teachpath_client.devices.cyberglove_wire import CYBERTOUCH, READY, STOP, write_sample
from teachpath_client.devices.fastrak import METRES
from teachpath_client.devices.fastrak_wire import ITEMS, Pose, write_record, write_status
from teachpath_client.devices.glove_calibration import GloveCalibration
from teachpath_client.reading import HandReading

LONGEST_COMMAND = 16  # bytes


class ProtocolSimulator(Protocol):
    """A device: what it answers, and what it sends of a reading."""

    streaming: bool

    def power_up(self) -> None:
        """Forget all settings, as when it is switched off and on."""

    def receive(self, content: bytes, reading: HandReading) -> bytes:
        """Take bytes from the host and return the answer; `reading` is what is measured now."""

    def record(self, reading: HandReading) -> bytes:
        """Return the record of a reading in the stream."""


class FastrakSimulator:
    """A FASTRAK with receivers at `stations`; it ignores `u` and `U` when `fixed_unit`."""

    COMMAND = re.compile(rb"([cCPfFuUS])|([lHO])(\d)(?:,([^\r]*))?\r")

    def __init__(self, stations: tuple[int, ...] = (1,), *, fixed_unit: bool = False) -> None:
        self._present, self._fixed_unit = stations, fixed_unit
        self.power_up()

    def power_up(self) -> None:
        """Return to the factory's settings: ASCII, inches, not continuous, all receivers on."""
        self.binary: bool = False
        self.streaming: bool = False
        self.unit: str = "in"
        self.active: set[int] = set(self._present)
        self.items: dict[int, str] = dict.fromkeys(self._present, "2,4,1")
        self.hemispheres: dict[int, str] = dict.fromkeys(self._present, "1,0,0")
        self._heard = b""

    def receive(self, content: bytes, reading: HandReading) -> bytes:
        """Take commands; answer `P` and `S`."""
        self._heard += content
        answer = b""
        while (match := self.COMMAND.search(self._heard)) is not None:
            self._heard = self._heard[match.end() :]
            answer += self._obey(match, reading)
        return answer

    def record(self, reading: HandReading) -> bytes:
        """Return the records of all stations that are on; receivers beside the hand are 10 cm apart."""
        return b"".join(self._record(reading, station) for station in sorted(self.active))

    def pose(self, reading: HandReading, station: int) -> Pose:
        """Return what a station measures, in the unit of the wire."""
        scale = METRES[self.unit]
        x, y, z = reading.position
        offset = 0.1 * (station - min(self._present))
        error = " " if reading.tracked else "D"
        position = ((x + offset) / scale, y / scale, z / scale)
        return Pose(station, error, position, reading.orientation or (1.0, 0.0, 0.0, 0.0))

    def _record(self, reading: HandReading, station: int) -> bytes:
        # Other output lists exist, but nobody asks for them here: a host that never set its own gets nothing usable.
        if self.items[station] != ITEMS:
            return f"0{station} \r\n".encode()
        return write_record(self.pose(reading, station), binary=self.binary)

    def _obey(self, match: re.Match[bytes], reading: HandReading) -> bytes:
        letter = (match[1] or match[2]).decode()
        if letter in "cC":
            self.streaming = letter == "C"
        elif letter in "fF":
            self.binary = letter == "f"
        elif letter in "uU" and not self._fixed_unit:
            self.unit = "cm" if letter == "u" else "in"
        elif letter == "P":
            return self.record(reading)
        elif letter == "S":
            station, centimetres = min(self._present), self.unit == "cm"
            return write_status(station, binary=self.binary, centimetres=centimetres, continuous=self.streaming)
        elif match[2] and int(match[3]) in self._present:
            self._set(letter, int(match[3]), match[4].decode())
        return b""

    def _set(self, letter: str, station: int, value: str) -> None:
        if letter == "l" and value == "1":
            self.active.add(station)
        elif letter == "l" and len(self.active) > 1:
            self.active.discard(station)
        elif letter == "H":
            self.hemispheres[station] = value
        elif letter == "O":
            self.items[station] = value


class GloveSimulator:
    """A CyberGlove whose raw values follow the inverse of `calibration`; a CyberTouch when `cybertouch`."""

    COMMAND = re.compile(rb"(?s)\x03|\?[GSP]|[GgSs]|[NUD].|A\xff.{6}|t \d+ \d+\r")

    def __init__(self, calibration: GloveCalibration, *, cybertouch: bool = True) -> None:
        self._calibration, self._cybertouch = calibration, cybertouch
        self.sensors: int = len(calibration.offset)
        self.amplitudes: list[int] = []  # amplitudes of the first actuator, in the order they were set
        self.power_up()

    def power_up(self) -> None:
        """Stop the stream and the vibration."""
        self.streaming: bool = False
        self._letter = b"S"
        self._heard = b""

    def receive(self, content: bytes, reading: HandReading) -> bytes:
        """Take commands and answer them; a streaming glove takes none but the end of the stream."""
        self._heard += content
        answer = b""
        while (match := self.COMMAND.match(self._heard)) is not None:
            self._heard = self._heard[match.end() :]
            if not self.streaming or match[0] == STOP:
                answer += self._obey(match[0], reading)
        if len(self._heard) > LONGEST_COMMAND:
            self._heard, answer = b"", answer + b"e?\0"
        return answer

    def record(self, reading: HandReading) -> bytes:
        """Return the sample of a reading in the stream."""
        return write_sample(self._letter, self._calibration.raw(reading.flexions))

    def _obey(self, command: bytes, reading: HandReading) -> bytes:
        letter = command[:1]
        if command == STOP:
            self.streaming = False
            return b""
        if letter == b"?":
            flags = bytes([0, 0, CYBERTOUCH if self._cybertouch else 0])
            return command + {b"G": bytes([READY]), b"S": bytes([self.sensors]), b"P": flags}[command[1:]] + b"\0"
        if command in (b"S", b"s"):
            self.streaming, self._letter = True, command
            return b""
        if command in (b"G", b"g"):
            return write_sample(command, self._calibration.raw(reading.flexions))
        if letter == b"A":
            self.amplitudes.append(command[2])
        return letter + b"\0"
