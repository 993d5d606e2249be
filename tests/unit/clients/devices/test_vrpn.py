"""VRPN: messages byte by byte, and a source beside a server that misbehaves, over real sockets."""

import itertools
import threading
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from teachpath_client.devices import open_source
from teachpath_client.devices.vrpn import VrpnSettings, VrpnSource
from teachpath_client.devices.vrpn_wire import Button, Pose, VrpnParser
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading
from tests.unit.clients.devices.vrpn_server import VrpnServer, descriptions, message, pose, press
from tests.waiting import wait_until

STAMP_NS, PERIOD_NS = 1_700_000_000_000_005_000, 10_000_000

# By hand after the description of the protocol: no library wrote them.
HAND = bytes.fromhex("00000021 00000000 00000000 00000001 ffffffff 00000000  00000005 68616e6400 00000000000000")
KIND = bytes.fromhex(
    "00000032 00000000 00000000 00000001 fffffffe 00000001"
    "00000016 7672706e5f547261636b657220506f735f5175617400 000000000000"
)
GOLDEN_POSE = bytes.fromhex(
    "00000058 6553f100 00000005 00000001 00000001 00000002"  # 88 bytes, 1700000000 s, 5 us, sender 1, kind 1
    "00000003 00000000"  # sensor 3
    "3ff8000000000000 c000000000000000 3fe0000000000000"  # 1.5, -2, 0.5
    "3ff0000000000000 0000000000000000 0000000000000000 0000000000000000"  # x, y, z, w = 1, 0, 0, 0
)


def records(content: bytes, parser: VrpnParser) -> list[Pose | Button]:
    return [record for record, _ in parser.feed(content)]


def test_a_pose_is_read_byte_by_byte() -> None:
    parser = VrpnParser("hand", 3)
    assert records(HAND + KIND + GOLDEN_POSE, parser) == [Pose(STAMP_NS, (1.5, -2.0, 0.5), (0.0, 1.0, 0.0, 0.0))]
    assert parser.trackers == {("hand", 3)}


def test_torn_messages_are_put_together_and_those_of_others_left_out() -> None:
    stream = descriptions() + pose(1000, (1.0, 2.0, 3.0), sender=0) + pose(2000, (1.0, 2.0, 3.0), sensor=1)
    stream += pose(3000, (1.0, 2.0, 3.0)) + message(1, 99, b"unknown") + press(1) + press(1, button=4) + press(0)
    whole = records(stream, VrpnParser("hand", 0, "trigger"))
    assert whole == [Pose(3000, (1.0, 2.0, 3.0), (1.0, 0.0, 0.0, 0.0)), Button(True), Button(False)]
    for size in (1, 7, 24, 100):
        parser = VrpnParser("hand", 0, "trigger")
        parts = [stream[begin : begin + size] for begin in range(0, len(stream), size)]
        assert [each for part in parts for each in records(part, parser)] == whole


def test_damaged_streams_end_in_a_sentence_or_in_records() -> None:
    stream = descriptions() + pose(1000, (1.0, 2.0, 3.0)) * 5 + press(1)
    said = []
    for seed in range(300):
        chance, damaged = np.random.default_rng(seed), bytearray(stream)
        for _ in range(3):
            damaged[chance.integers(len(damaged))] = chance.integers(256)
        try:
            records(bytes(damaged), VrpnParser("hand", 0, "trigger"))
        except ClientError as error:
            said.append(str(error))
    assert said
    assert all("VRPN" in sentence for sentence in said)


@pytest.mark.parametrize("length", [b"\0\0\0\x17", b"\x7f\xff\xff\xff", b"\xff\xff\xff\xff"])
def test_a_length_that_is_none_is_refused(length: bytes) -> None:
    with pytest.raises(ClientError, match="what comes is none"):
        VrpnParser("hand", 0).feed(length + bytes(20))


@pytest.fixture
def server() -> Iterator[VrpnServer]:
    with VrpnServer() as server:
        yield server


class Sender:
    """Sends poses 10 ms apart, each 0.1 m further, until it is told to end; use it as a context manager.

    Attributes:
        sent: how many.
    """

    def __init__(self, server: VrpnServer) -> None:
        self.sent = 0
        self._server, self._over = server, threading.Event()
        self._thread = threading.Thread(target=self._send)

    def __enter__(self) -> "Sender":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()

    def _send(self) -> None:
        while not self._over.wait(0.002):
            self.sent += 1
            self._server.send(pose(STAMP_NS + self.sent * PERIOD_NS, (0.1 * self.sent, 0.0, 0.5)))


def options(server: VrpnServer, **more: str) -> dict[str, str]:
    return {"server": server.address, "tracker": "hand", "wait": "300", "silence": "300"} | more


def gathered(stream: Iterator[HandReading], enough: Callable[[HandReading], bool]) -> list[HandReading]:
    """Return readings up to the first one for which `enough` is true."""
    found = [next(stream)]
    while not enough(found[-1]):
        found.append(next(stream))
    return found


def test_poses_become_readings_with_the_stamps_of_the_server_and_its_button(server: VrpnServer) -> None:
    with Sender(server), open_source("vrpn", options(server, grasp="trigger")) as source:
        stream = iter(source)
        first = next(stream)
        server.send(press(1))
        readings = gathered(stream, lambda reading: reading.buttons == 1)
    assert (first.time, first.orientation, first.buttons) == (0.0, (1.0, 0.0, 0.0, 0.0), 0)
    for reading in (first, *readings):
        assert reading.device_ns is not None
        steps, rest = divmod(reading.device_ns - STAMP_NS, PERIOD_NS)
        assert (rest, reading.position) == (0, (0.1 * steps, 0.0, 0.5))


def test_what_comes_again_and_out_of_turn_is_left_out(server: VrpnServer) -> None:
    stamps = [STAMP_NS + number * PERIOD_NS for number in range(1, 6)]
    with (
        Sender(server) as sender,
        open_source("vrpn", options(server)) as source,
    ):
        stream = iter(source)
        next(stream)
        sender.__exit__()
        late = [STAMP_NS + 10**12 + each for each in stamps]
        for stamp in (late[0], late[0], late[2], late[1], late[3], late[4]):
            server.send(pose(stamp, (9.0, 0.0, 0.5)))
        readings = gathered(stream, lambda reading: reading.device_ns == late[4])
    assert [each.device_ns for each in readings if each.position[0] == 9.0] == [late[0], *late[2:]]


def test_a_server_that_broke_off_is_connected_again(server: VrpnServer, caplog: pytest.LogCaptureFixture) -> None:
    with Sender(server) as sender, open_source("vrpn", options(server)) as source:
        stream = iter(source)
        before = next(stream)
        server.break_off()
        wait_until(lambda: server.connections == 2, "it is connected again")
        sent = sender.sent
        after = gathered(stream, lambda reading: reading.position[0] > 0.1 * (sent + 1))[-1]
    assert after.time > before.time
    assert "trying again until it is back" in caplog.text


@pytest.mark.parametrize(
    ("wanted", "sentence"),
    [
        ({"tracker": "table"}, r"sends no pose of table, sensor 0, within 200 s; it sends: hand \(sensor 0\)"),
        ({"tracker": "hand", "sensor": 4}, r"no pose of hand, sensor 4, .* it sends: hand \(sensor 0\)"),
    ],
)
def test_a_tracker_that_is_not_there_is_said_with_those_that_are(
    server: VrpnServer, wanted: dict[str, Any], sentence: str
) -> None:
    looks = itertools.count()  # time goes on by a second whenever it is looked at
    source = VrpnSource(VrpnSettings(server.address, wait=200.0, **wanted), clock=lambda: float(next(looks)))
    with Sender(server), pytest.raises(ClientError, match=sentence), source:
        pass


@pytest.mark.parametrize("port", ["http", "0", "65536", ""])
def test_a_port_that_is_none_is_said(port: str) -> None:
    with pytest.raises(ClientError, match=f"'{port}' is no port"):
        open_source("vrpn", {"server": f"127.0.0.1:{port}", "tracker": "hand"})


def test_somebody_else_and_nobody_are_said() -> None:
    with (
        VrpnServer(b"SSH-2.0-OpenSSH_9.2".ljust(24)) as server,
        pytest.raises(ClientError, match="no server of VRPN 7: it says b'SSH-2"),
        open_source("vrpn", options(server)),
    ):
        pass
    nobody = {"server": "127.0.0.1:9", "tracker": "hand"}
    with pytest.raises(ClientError, match="nobody answers at"), open_source("vrpn", nobody):
        pass
