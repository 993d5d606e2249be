"""The bytes of an Immersion (Virtual Technologies) CyberGlove and CyberTouch: commands, samples, vibration.

Every answer ends with a zero byte, and no sensor ever reads zero: that is what the parsers synchronise on.

    G  g      one sample, binary or ASCII          ?G  answer "?G" v 0: bit 1 glove plugged in, bit 0 initialised
    S  s      a stream of samples, until 03 hex    ?S  answer "?S" n 0: sensors in the glove
    N n       sensors in a sample; answer "N" 0    ?P  answer "?P" f f f 0: flags; bit 1 of the third: CyberTouch
    U n  D n  add status, time stamp to samples    A 255 a a a a a a  vibration of thumb, index, middle, ring,
    t w v<>   period of the stream: w v / 115200 s                    little finger, palm, 0 to 255; answer "A" 0

Capital letters take and give bytes, small ones ASCII numbers with a carriage return (<>). An error is "e" and a letter:
? unknown command, g not plugged in, n wrong number, s too fast.

A sample without status and time stamp, of n = 18 or 22 sensors:

    byte       binary                       ASCII
    letter     0      "S", or "G" if asked  0    "s", or "g" if asked
    sensors    1-n    1 to 255 each         1-   n times a blank and a number
    end        n + 1  0                          carriage return, line feed, 0

A sample that could not be measured ends with an error before the zero: "eg" or "es". A byte that was changed on the way
cannot be told from a reading: the protocol has no check sum.

Sources, all of them drivers that follow the *CyberGlove User's Manual* and *Reference Manual* of Virtual
Technologies: ViSTA of RWTH Aachen (`VistaCyberGloveDriver`, which cites the manual by page: G, S, 03 hex, N, U, D,
?G, ?S, errors in a sample, the period as w counted v times), toon (`cyberglove`: `t 1152 1` is 100 Hz, `u`, 03 hex),
puppet (`CyberGlove`, with the manual's list of commands: 03 hex, errors, w = 115200 / rate), Shadow Robot
(`sr_teleop_devices/cyberglove`: S, the stream's form, `t` with four examples of rates, `u`), the KIT
(`asr_cyberglove_lib`: every command above with its answer, `A` 255), UCF (VESS, `vsCyberGloveBox`: G, N, ?G = 3, ?S,
the flag of the CyberTouch, `A` and its six places), FreeVR (`vr_input.cyberglove`: ASCII forms, the zero at the end,
errors), intellsensing (`cyberglove`: 20 and 24 bytes of a sample).

*Unconfirmed*, and read so that it does not matter: carriage return and line feed of an ASCII sample (only the line
feed was seen, in a transcript; both may be missing), and whether a streaming glove takes another command (libglove
says no, ViSTA sends none because the answers would be mixed up; so a glove that vibrates is asked for each sample).
The places of `A` and the flag of the CyberTouch rest on one driver. No glove was at hand: all was tested against the
simulator in `protocol_simulators.py`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

SENSORS = (18, 22)
ACTUATORS = 6
LONGEST_SAMPLE = 4 * 22 + 16  # bytes of the longest sample, ASCII
TICK_RATE = 115200  # a second, of the stream's period
READY = 3  # answer to ?G of a glove that is plugged in and initialised
CYBERTOUCH = 0x02  # in the third byte of the answer to ?P
STOP = b"\x03"
ERRORS = (b"eg", b"es")  # at the end of a sample that was not measured: not plugged in, too fast


class GloveParser:
    """Finds samples of `sensors` raw values: the end of what stands before each zero byte."""

    def __init__(self, sensors: int) -> None:
        self._sensors = sensors
        self._ascii = re.compile(rb"[sg]((?: +\d{1,3}){%d}) *\r?\n?" % sensors)
        self._buffer = bytearray()

    def feed(self, content: bytes) -> list[tuple[tuple[int, ...], int]]:
        """Take bytes; return the samples that they complete, each with the number of bytes that came after it."""
        self._buffer += content
        found, at = [], 0
        while (end := self._buffer.find(0, at)) >= 0:
            sample = self._read(bytes(self._buffer[at:end]))
            at = end + 1
            if sample is not None:
                found.append((sample, len(self._buffer) - at))
        del self._buffer[: max(at, len(self._buffer) - LONGEST_SAMPLE)]
        return found

    def _read(self, answer: bytes) -> tuple[int, ...] | None:
        if answer.endswith(ERRORS) and answer[-(self._sensors + 3) :][:1] in (b"S", b"G"):
            return None
        binary = answer[-(self._sensors + 1) :]
        if len(binary) == self._sensors + 1 and binary[:1] in (b"S", b"G"):
            return tuple(binary[1:])
        start = max(answer.rfind(b"s"), answer.rfind(b"g"), 0)
        match = self._ascii.fullmatch(answer[start:])
        values = tuple(map(int, match[1].split())) if match else ()
        return values if values and min(values) >= 1 and max(values) <= 255 else None


def write_sample(letter: bytes, raw: Sequence[int]) -> bytes:
    """Return the bytes of a sample, as the glove sends it; the letter says how it was asked for."""
    if letter in (b"S", b"G"):
        return letter + bytes(raw) + b"\0"
    return letter + "".join(f" {value}" for value in raw).encode() + b"\r\n\0"


def vibration(amplitude: int) -> bytes:
    """Return the command that sets all actuators to `amplitude`, 0 to 255."""
    return b"A\xff" + bytes([amplitude] * ACTUATORS)


def period(rate: float) -> bytes:
    """Return the command that sets the stream to `rate` [Hz]."""
    return f"t {round(TICK_RATE / rate)} 1\r".encode()
