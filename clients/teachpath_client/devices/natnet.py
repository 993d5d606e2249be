"""Rigid bodies of OptiTrack Motive as sources, by NatNet in unicast: Motive streams to this client alone."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from teachpath_client.devices.byte_stream import ByteStream, UdpStream, split_address
from teachpath_client.devices.connection import Connection
from teachpath_client.devices.live_device import READ_TIMEOUT, LiveDevice
from teachpath_client.devices.natnet_wire import (
    PORT,
    Kind,
    RigidBody,
    Version,
    command,
    read_frame,
    rigid_body_names,
    split,
    stream_version,
)
from teachpath_client.devices.source import Capabilities, configure
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading

KEEP_ALIVE_PERIOD = 1.0  # [s]; Motive ends a unicast stream when it hears nothing for some seconds
ASK_PERIOD = 0.5  # [s] between questions while nothing answers: datagrams get lost
RESTART = 1.0  # [s] by which the server's time runs back when it was started anew, not when a datagram is late


@dataclass(frozen=True)
class NatNetSettings:
    """What is followed."""

    # where Motive is: HOST or HOST:PORT
    server: str
    # the rigid body: its name in Motive, or its streaming number
    body: str
    # [s] to wait for an answer
    wait: float = 5.0
    # [s] without a frame after which the server is asked anew
    silence: float = 2.0


class FrameParser:
    """Finds one rigid body in the frames, each a datagram.

    Args:
        body: its number.
        version: of the stream.
    """

    def __init__(self, body: int, version: Version) -> None:
        self._body, self._version = body, version

    def feed(self, content: bytes) -> list[tuple[RigidBody, int]]:
        """Take a datagram; return what it says of the body; raises ClientError when it is torn or none of NatNet."""
        if not content:
            return []
        kind, body = split(content)
        if kind != Kind.FRAME:
            return []
        found = read_frame(body, self._version).bodies.get(self._body)
        return [] if found is None else [(found, 0)]


class NatNetProtocol:
    """Asks a server for its version and what it tracks, and says from then on that somebody listens."""

    def __init__(self, settings: NatNetSettings, clock: Callable[[], float] = time.monotonic) -> None:
        self._settings, self._clock = settings, clock
        self._kept_alive_at = float("-inf")

    def set_up(self, line: ByteStream) -> FrameParser:
        """Return the parser of frames; raises ClientError when nobody answers, or does not have the rigid body."""
        nobody = f"{line.path} does not answer; does Motive stream there, with transmission type Unicast?"
        version = stream_version(self._ask(line, Kind.CONNECT, Kind.SERVER_INFO, nobody))
        if self._settings.body.isdecimal():
            return FrameParser(int(self._settings.body), version)
        silent = f"{line.path} does not say which rigid bodies it has; give body=NUMBER"
        names = rigid_body_names(self._ask(line, Kind.REQUEST_DESCRIPTIONS, Kind.DESCRIPTIONS, silent), version)
        if self._settings.body not in names:
            there = ", ".join(f"{name} ({number})" for name, number in sorted(names.items())[:20])
            raise ClientError(f"{line.path} has no rigid body {self._settings.body}; it has: {there or 'none'}")
        return FrameParser(names[self._settings.body], version)

    def poll(self, line: ByteStream) -> float:
        """Say that somebody listens, when that is due."""
        if self._clock() - self._kept_alive_at >= KEEP_ALIVE_PERIOD:
            self._kept_alive_at = self._clock()
            line.write(command(Kind.KEEP_ALIVE))
        return READ_TIMEOUT

    def shut_down(self, line: ByteStream) -> None:
        """Do nothing: a server notices that nobody says any more that it listens."""

    def _ask(self, line: ByteStream, question: Kind, answer: Kind, sentence: str) -> bytes:
        """Return the body of the answer to a question, which is asked again and again; frames may come between."""
        until, due = self._clock() + self._settings.wait, float("-inf")
        while (now := self._clock()) <= until:
            if now >= due:
                due = now + ASK_PERIOD
                line.write(command(question))
            if content := line.read(READ_TIMEOUT):
                kind, body = split(content)
                if kind == answer:
                    return body
        raise ClientError(sentence)


class NatNetSource(LiveDevice[RigidBody]):
    """Readings of one rigid body, with the times of its server; those whose time is not a later one are left out.

    NatNet counts its time from the start of its program. The first frame, and the first after a new start, is dated
    with the time of day here, and those that follow by the server's time.

    Args:
        settings: what is followed.
        clock: [s] that never runs back.
        time_of_day: [ns since the Unix epoch].
    """

    def __init__(
        self,
        settings: NatNetSettings,
        *,
        clock: Callable[[], float] = time.monotonic,
        time_of_day: Callable[[], int] = time.time_ns,
    ) -> None:
        line = UdpStream(*split_address("server", settings.server, PORT))
        protocol = NatNetProtocol(settings, clock)
        super().__init__(Connection[RigidBody](line, protocol, silence=settings.silence, clock=clock))
        self._time_of_day = time_of_day
        self._newest = float("inf")  # [s] of the server's time; the first frame is a new start
        self._origin_ns = 0

    @property
    def capabilities(self) -> Capabilities:
        """Poses, live; the rate is the server's."""
        return Capabilities(rate=0.0, sensors=0, orientation=True, live=True)

    def _reading(self, record: RigidBody) -> HandReading | None:
        if record.seconds < self._newest - RESTART:
            self._origin_ns = self._time_of_day() - round(record.seconds * 1e9)
        elif record.seconds <= self._newest:
            return None
        self._newest = record.seconds
        return HandReading(
            0.0,
            record.position,
            record.orientation,
            tracked=record.tracked,
            device_ns=self._origin_ns + round(record.seconds * 1e9),
        )


def natnet(**options: str) -> NatNetSource:
    """A rigid body of OptiTrack Motive, by NatNet in unicast; server=HOST, body=NAME or NUMBER."""
    return NatNetSource(configure(NatNetSettings, options))
