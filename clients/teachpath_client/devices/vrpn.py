"""Trackers of a VRPN server as sources: Vicon Tracker, OptiTrack Motive, Polhemus and many others have one."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from teachpath_client.devices.byte_stream import ByteStream, TcpStream, split_address
from teachpath_client.devices.connection import Connection
from teachpath_client.devices.live_device import READ_TIMEOUT, LiveDevice
from teachpath_client.devices.source import Capabilities, configure
from teachpath_client.devices.vrpn_wire import COOKIE, COOKIE_BEGIN, PORT, Button, Pose, VrpnParser
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading

GRASP_BUTTON = 1
Record = Pose | Button


@dataclass(frozen=True)
class VrpnSettings:
    """What is followed."""

    # where the server is: HOST or HOST:PORT
    server: str
    # its name there, e.g. that of a rigid body
    tracker: str
    # which of its sensors
    sensor: int = 0
    # name of a device whose button says that the hand grasps
    grasp: str = ""
    # which of its buttons
    button: int = 0
    # [s] to wait for the first pose
    wait: float = 5.0
    # [s] without a pose after which the server is connected anew
    silence: float = 5.0


class VrpnProtocol:
    """Exchanges cookies with a server, and waits until the tracker sends."""

    def __init__(self, settings: VrpnSettings, clock: Callable[[], float] = time.monotonic) -> None:
        self._settings, self._clock = settings, clock

    def set_up(self, line: ByteStream) -> VrpnParser:
        """Return the parser of what comes; raises ClientError when it is no server, or does not have the tracker."""
        settings, until = self._settings, self._clock() + self._settings.wait
        line.write(COOKIE)
        came = b""
        while len(came) < len(COOKIE):
            self._check(until, f"{line.path} says nothing; does VRPN listen there?")
            came += line.read(READ_TIMEOUT)
        if not came.startswith(COOKIE_BEGIN):
            raise ClientError(f"{line.path} is no server of VRPN 7: it says {came[:16]!r}")
        parser = VrpnParser(settings.tracker, settings.sensor, settings.grasp, settings.button)
        parser.feed(came[len(COOKIE) :])
        while (settings.tracker, settings.sensor) not in parser.trackers:
            there = ", ".join(f"{name} (sensor {sensor})" for name, sensor in sorted(parser.trackers)[:20])
            self._check(
                until,
                f"{line.path} sends no pose of {settings.tracker}, sensor {settings.sensor}, within {settings.wait:g} "
                f"s; it sends: {there or 'none'}",
            )
            parser.feed(line.read(READ_TIMEOUT))
        return parser

    def poll(self, line: ByteStream) -> float:
        """Ask for nothing: a server sends by itself."""
        return READ_TIMEOUT

    def shut_down(self, line: ByteStream) -> None:
        """Do nothing: a server notices that the connection ends."""

    def _check(self, until: float, sentence: str) -> None:
        if self._clock() > until:
            raise ClientError(sentence)


class VrpnSource(LiveDevice[Record]):
    """Readings of one sensor, with the stamps of its server; those whose stamp is not a later one are left out.

    Args:
        settings: what is followed.
        clock: [s] that never runs back.
    """

    def __init__(self, settings: VrpnSettings, *, clock: Callable[[], float] = time.monotonic) -> None:
        line, protocol = TcpStream(*split_address("server", settings.server, PORT)), VrpnProtocol(settings, clock)
        super().__init__(Connection[Record](line, protocol, silence=settings.silence, clock=clock))
        self._newest, self._grasps = 0, False

    @property
    def capabilities(self) -> Capabilities:
        """Poses, live; the rate is the server's."""
        return Capabilities(rate=0.0, sensors=0, orientation=True, live=True)

    def _reading(self, record: Record) -> HandReading | None:
        if isinstance(record, Button):
            self._grasps = record.pressed
            return None
        if 0 < record.stamp_ns <= self._newest:
            return None
        self._newest = record.stamp_ns
        return HandReading(
            0.0,
            record.position,
            record.orientation,
            buttons=GRASP_BUTTON if self._grasps else 0,
            device_ns=record.stamp_ns or None,
        )


def vrpn(**options: str) -> VrpnSource:
    """A tracker of a VRPN server (Vicon, OptiTrack, ...); server=HOST, tracker=NAME, sensor=0, grasp=DEVICE."""
    return VrpnSource(configure(VrpnSettings, options))
