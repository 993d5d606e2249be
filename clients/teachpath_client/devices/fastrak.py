"""The Polhemus FASTRAK as a source: position and orientation of the hand from one of its receivers."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

from teachpath_client.devices.byte_stream import ByteStream
from teachpath_client.devices.connection import Connection
from teachpath_client.devices.fastrak_wire import (
    ITEMS,
    STATIONS,
    STATUS_SIZE,
    AsciiParser,
    BinaryParser,
    Pose,
    read_status,
)
from teachpath_client.devices.live_device import READ_TIMEOUT, LiveDevice, Polling
from teachpath_client.devices.serial_line import SerialLine
from teachpath_client.devices.source import Capabilities, configure
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading

METRES = {"cm": 0.01, "in": 0.0254}
MAX_RECORD_RATE = 120.0  # all stations together
ATTEMPTS = 3


@dataclass(frozen=True)
class FastrakSettings:
    """How a FASTRAK is connected and set up."""

    # path of its serial line
    port: str
    # speed set by the switches at its back
    baud: int = 115200
    # of the data records
    format: Literal["binary", "ascii"] = "binary"
    # continuous: it sends by itself; polled: it is asked `rate` times a second
    mode: Literal["continuous", "polled"] = "continuous"
    # [Hz] of asking
    rate: float = 50.0
    # unit it is set to; readings are in metres with either
    unit: Literal["cm", "in"] = "cm"
    # side of the transmitter on which the hand moves, along its axes
    hemisphere: Literal["+x", "-x", "+y", "-y", "+z", "-z"] = "+x"
    # receivers to switch on, the hand's first; all others are switched off
    stations: tuple[int, ...] = (1,)
    # [s] without a record after which it is set up again
    silence: float = 1.0
    # [s] between commands; the device needs time to take them
    pause: float = 0.05

    def __post_init__(self) -> None:
        if not self.stations or not set(self.stations) <= set(STATIONS):
            raise ClientError(f"stations={','.join(map(str, self.stations))}: a FASTRAK has the stations 1 to 4")
        if not 1.0 <= self.rate <= MAX_RECORD_RATE:
            raise ClientError(f"rate={self.rate:g} is outside 1 to {MAX_RECORD_RATE:g} Hz")
        if not 0.1 <= self.silence <= 60.0:
            raise ClientError(f"silence={self.silence:g} is outside 0.1 to 60 s")
        if not 0.0 <= self.pause <= 1.0:
            raise ClientError(f"pause={self.pause:g} is outside 0 to 1 s")


class FastrakProtocol:
    """Sets a FASTRAK up, checks that it took unit and format, and asks it for records when polled."""

    def __init__(self, settings: FastrakSettings, clock: Callable[[], float] = time.monotonic) -> None:
        self._settings, self._clock = settings, clock
        self._polling = Polling(settings.rate, clock)

    def set_up(self, line: ByteStream) -> BinaryParser | AsciiParser:
        """Set the device up; raises ClientError when it does not answer or does not take the unit or the format."""
        wanted = (self._settings.format == "binary", self._settings.unit == "cm")
        said = None
        for _ in range(ATTEMPTS):
            for command in self._commands():
                line.write(command)
                self._drain(line)
            line.write(b"S")
            said = self._status(line)
            if said == wanted:
                if self._settings.mode == "continuous":
                    line.write(b"C")
                return BinaryParser() if wanted[0] else AsciiParser()
        if said is None:
            raise ClientError(
                f"no FASTRAK answers at {line.path} with {line.baud} baud; is it switched on, and are the switches at "
                "its back set to this speed?"
            )
        # A position in the wrong unit looks like a position; such a device must not be used.
        raise ClientError(
            f"the FASTRAK at {line.path} was asked for {self._settings.unit} in {self._settings.format} records, but "
            f"says that it sends {'cm' if said[1] else 'in'} in {'binary' if said[0] else 'ascii'}; power-cycle it"
        )

    def poll(self, line: ByteStream) -> float:
        """Ask for a record when it is time to; return the seconds until the next time."""
        if self._settings.mode == "continuous":
            return READ_TIMEOUT
        if self._polling.is_due:
            line.write(b"P")
        return self._polling.wait

    def shut_down(self, line: ByteStream) -> None:
        """End the continuous output."""
        line.write(b"c")

    def _commands(self) -> Iterator[bytes]:
        settings = self._settings
        yield b"c"
        yield b"u" if settings.unit == "cm" else b"U"
        yield b"f" if settings.format == "binary" else b"F"
        direction = ["0", "0", "0"]
        direction["xyz".index(settings.hemisphere[1])] = "1" if settings.hemisphere[0] == "+" else "-1"
        for station in settings.stations:
            yield f"l{station},1\r".encode()
            yield f"H{station},{','.join(direction)}\r".encode()
            yield f"O{station},{ITEMS}\r".encode()
        # The last station that is on cannot be switched off, so these come after the others.
        for station in STATIONS:
            if station not in settings.stations:
                yield f"l{station},0\r".encode()

    def _drain(self, line: ByteStream) -> None:
        end = self._clock() + self._settings.pause
        while (left := end - self._clock()) > 0:
            line.read(left)

    def _status(self, line: ByteStream) -> tuple[bool, bool] | None:
        heard, end = b"", self._clock() + max(0.5, 20 * STATUS_SIZE / line.baud)
        while (left := end - self._clock()) > 0:
            heard += line.read(left)
            if (said := read_status(heard)) is not None:
                return said
        return None


def fastrak(**options: str) -> FastrakSource:
    """Polhemus FASTRAK on a serial line: position and orientation, no glove; port=PATH."""
    return FastrakSource(configure(FastrakSettings, options))


class FastrakSource(LiveDevice[Pose]):
    """One receiver of a FASTRAK, live; a reading is not tracked when the device reports an error with it."""

    def __init__(self, settings: FastrakSettings, *, clock: Callable[[], float] = time.monotonic) -> None:
        line, protocol = SerialLine(settings.port, settings.baud), FastrakProtocol(settings, clock)
        super().__init__(Connection(line, protocol, silence=settings.silence, clock=clock))
        self.settings: FastrakSettings = settings

    @property
    def capabilities(self) -> Capabilities:
        """Position and orientation, live."""
        streams = MAX_RECORD_RATE / len(self.settings.stations)
        rate = streams if self.settings.mode == "continuous" else self.settings.rate
        return Capabilities(rate=rate, sensors=0, orientation=True, live=True)

    def _reading(self, record: Pose) -> HandReading | None:
        if record.station != self.settings.stations[0]:
            return None
        x, y, z = (METRES[self.settings.unit] * value for value in record.position)
        return HandReading(0.0, (x, y, z), record.orientation, tracked=record.error == " ")
