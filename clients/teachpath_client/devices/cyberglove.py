"""The CyberGlove and the CyberTouch: flexions of the hand, and vibration for the hand that holds something."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import Literal

from teachpath_client.devices.byte_stream import ByteStream
from teachpath_client.devices.connection import Connection
from teachpath_client.devices.cyberglove_wire import CYBERTOUCH, READY, SENSORS, STOP, GloveParser, period, vibration
from teachpath_client.devices.glove_calibration import GloveCalibration
from teachpath_client.devices.live_device import READ_TIMEOUT, LiveDevice, Polling
from teachpath_client.devices.serial_line import SerialLine
from teachpath_client.devices.source import Capabilities, configure
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading

Raw = tuple[int, ...]

ATTEMPTS = 3
ANSWER_TIMEOUT = 0.5  # [s] the glove may take to answer
QUIET_TIME = 0.05  # [s] without a byte after which a stream counts as ended
CLOSED_ABOVE, OPEN_BELOW = 0.6, 0.4  # mean flexion over and under which the hand counts as closed and open


@dataclass(frozen=True)
class GloveSettings:
    """How a glove is connected and set up."""

    # path of its serial line
    port: str
    # file made by `teachpath-client glove-calibrate`
    calibration: str = ""
    # speed set by the switches at its back
    baud: int = 115200
    # of the samples
    format: Literal["binary", "ascii"] = "binary"
    # stream: it sends by itself; polled: it is asked for each sample (always so with touch)
    mode: Literal["stream", "polled"] = "stream"
    # [Hz] of samples
    rate: float = 100.0
    # when a CyberTouch vibrates: never, when the hand closes, or when the station says that it carries the object
    touch: Literal["off", "closure", "phase"] = "off"
    # of the vibration, 1 to 255
    amplitude: int = 128
    # [s] without a sample after which it is set up again
    silence: float = 1.0

    def __post_init__(self) -> None:
        if not 2.0 <= self.rate <= 150.0:
            raise ClientError(f"rate={self.rate:g} is outside 2 to 150 Hz")
        if not 1 <= self.amplitude <= 255:
            raise ClientError(f"amplitude={self.amplitude} is outside 1 to 255")
        if not 0.1 <= self.silence <= 60.0:
            raise ClientError(f"silence={self.silence:g} is outside 0.1 to 60 s")


class GloveProtocol:
    """Sets a glove up, asks it for samples when polled, and makes it vibrate.

    Args:
        settings: of the glove.
        sensors: that it must have; 0: take the glove as it is.
        clock: [s] that never runs back.
    """

    def __init__(self, settings: GloveSettings, sensors: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._settings, self._sensors, self._clock = settings, sensors, clock
        self._polled = settings.mode == "polled" or settings.touch != "off"
        self._polling = Polling(settings.rate, clock)
        self._sent_amplitude = 0
        self.amplitude: int = 0  # what the hand should feel now

    def set_up(self, line: ByteStream) -> GloveParser:
        """Set the glove up; raises ClientError when it does not answer or is not the glove it should be."""
        line.write(STOP)
        end = self._clock() + ANSWER_TIMEOUT
        while self._clock() < end and line.read(QUIET_TIME):
            pass
        if self._ask(line, b"?G", 1)[0] & READY != READY:
            raise ClientError(f"the glove at {line.path} is not plugged into its box, or not initialised")
        sensors = self._ask(line, b"?S", 1)[0]
        if sensors not in SENSORS or (self._sensors and sensors != self._sensors):
            wanted = self._sensors or "18 or 22"
            raise ClientError(f"the glove at {line.path} has {sensors} sensors, not {wanted}; is this its calibration?")
        if self._settings.touch != "off" and not self._ask(line, b"?P", 3)[2] & CYBERTOUCH:
            raise ClientError(f"the glove at {line.path} is no CyberTouch; leave out touch={self._settings.touch}")
        self._write(line, b"N", sensors)
        self._write(line, b"U", 0)
        self._write(line, b"D", 0)
        if not self._polled:
            line.write(period(self._settings.rate))
            line.write(b"S" if self._settings.format == "binary" else b"s")
        self._sent_amplitude = 0
        return GloveParser(sensors)

    def poll(self, line: ByteStream) -> float:
        """Ask for a sample and change the vibration when it is time to; return the seconds until the next time."""
        if self._settings.touch != "off" and self.amplitude != self._sent_amplitude:
            self._sent_amplitude = self.amplitude
            line.write(vibration(self._sent_amplitude))
        if not self._polled:
            return READ_TIMEOUT
        if self._polling.is_due:
            line.write(b"G" if self._settings.format == "binary" else b"g")
        return self._polling.wait

    def shut_down(self, line: ByteStream) -> None:
        """End the stream and the vibration."""
        line.write(STOP)
        if self._settings.touch != "off":
            line.write(vibration(0))

    def _write(self, line: ByteStream, letter: bytes, value: int) -> None:
        self._exchange(line, letter + bytes([value]), letter, 0)

    def _ask(self, line: ByteStream, question: bytes, size: int) -> bytes:
        return self._exchange(line, question, question, size)

    def _exchange(self, line: ByteStream, said: bytes, echo: bytes, size: int) -> bytes:
        """Send a command until it is answered by its echo, `size` bytes and a zero; return the bytes."""
        for _ in range(ATTEMPTS):
            line.write(said)
            heard, end = b"", self._clock() + ANSWER_TIMEOUT
            while (left := end - self._clock()) > 0:
                heard += line.read(left)
                start = heard.find(echo) + len(echo)
                if echo in heard and len(heard) > start + size and heard[start + size] == 0:
                    return heard[start : start + size]
        raise ClientError(
            f"no CyberGlove answers {echo.decode()} at {line.path} with {line.baud} baud; is it switched on, and are "
            "the switches at its back set to this speed?"
        )


def cyberglove(**options: str) -> GloveSource:
    """CyberGlove or CyberTouch on a serial line: flexions without a pose; port=PATH, calibration=FILE."""
    return GloveSource(configure(GloveSettings, options))


class GloveSource(LiveDevice[Raw]):
    """A glove, live. No reading is tracked, because a glove does not measure where it is."""

    def __init__(self, settings: GloveSettings, *, clock: Callable[[], float] = time.monotonic) -> None:
        if not settings.calibration:
            raise ClientError(
                "the glove needs the option calibration=FILE; make one with teachpath-client glove-calibrate"
            )
        self.settings: GloveSettings = settings
        self.calibration: GloveCalibration = GloveCalibration.load(Path(settings.calibration))
        self._protocol = GloveProtocol(settings, len(self.calibration.offset), clock)
        super().__init__(connect(settings, self._protocol, clock))

    @property
    def capabilities(self) -> Capabilities:
        """Flexions, live."""
        return Capabilities(
            rate=self.settings.rate,
            sensors=len(self.calibration.offset),
            orientation=False,
            live=True,
            touch=self.settings.touch == "phase",
        )

    def touch(self, holding: bool) -> None:
        """Start the vibration when the hand holds the object, or stop it."""
        self._protocol.amplitude = self.settings.amplitude if holding else 0

    def _reading(self, record: Raw) -> HandReading:
        flexions = self.calibration.flexions(record)
        if self.settings.touch == "closure":
            closure = fmean(flexions)
            if closure > CLOSED_ABOVE or closure < OPEN_BELOW:
                self.touch(closure > CLOSED_ABOVE)
        return HandReading(0.0, (0.0, 0.0, 0.0), None, flexions, tracked=False)


def connect(
    settings: GloveSettings, protocol: GloveProtocol, clock: Callable[[], float] = time.monotonic
) -> Connection[Raw]:
    """Return the connection with a glove, not yet made; it gives raw samples."""
    return Connection[Raw](SerialLine(settings.port, settings.baud), protocol, silence=settings.silence, clock=clock)
