"""NatNet: datagrams byte by byte, and a source beside a server that misbehaves, over real sockets."""

import itertools
import threading
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from teachpath_client.devices import open_source
from teachpath_client.devices.natnet import NatNetSettings, NatNetSource
from teachpath_client.devices.natnet_wire import Kind, RigidBody, command, read_frame, rigid_body_names, split
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading
from tests.unit.clients.devices.natnet_server import NAMES, NatNetServer, datagram, descriptions, frame, rigid_body
from tests.waiting import wait_until

VERSIONS = [(3, 0), (3, 1), (4, 0), (4, 1), (4, 2)]
PERIOD = 0.01  # [s]

# By hand after the description of the stream, version 3.0: no library wrote it.
GOLDEN_FRAME = bytes.fromhex(
    "0700 8600"  # a frame, 134 bytes
    "2a000000"  # number 42
    "01000000 6800 01000000 0000803f 00000000 00000000"  # one set of markers, "h", with one marker
    "00000000"  # no other markers
    "01000000 05000000 0000c03f 000000c0 0000003f 0000803f 00000000 00000000 00000000 6f12833a 0100"  # body 5
    "00000000 00000000 00000000 00000000"  # no skeletons, labelled markers, force plates, devices
    "00000000 00000000 0000000000002940 0100000000000000 0200000000000000 0300000000000000 0000 00000000"  # 12.5 s
)


def test_a_frame_is_read_byte_by_byte() -> None:
    kind, body = split(GOLDEN_FRAME)
    found = read_frame(body, (3, 0))
    assert (kind, found.number) == (Kind.FRAME, 42)
    assert found.bodies == {5: RigidBody(12.5, (1.5, -2.0, 0.5), (0.0, 1.0, 0.0, 0.0), tracked=True)}


def test_questions_are_written_as_described() -> None:
    assert command(Kind.CONNECT) == bytes.fromhex("0000 0500 50696e6700")
    assert command(Kind.KEEP_ALIVE) == bytes.fromhex("0a00 0000")


@pytest.mark.parametrize("version", VERSIONS)
def test_every_version_is_understood(version: tuple[int, int]) -> None:
    bodies = [rigid_body(3, (0.0, 0.0, 0.0)), rigid_body(7, (0.5, 1.0, 2.0), tracked=False)]
    found = read_frame(split(frame(3.25, bodies, version))[1], version)
    assert found.bodies[7] == RigidBody(3.25, (0.5, 1.0, 2.0), (1.0, 0.0, 0.0, 0.0), tracked=False)
    assert set(found.bodies) == {3, 7}
    assert rigid_body_names(split(descriptions(version))[1], version) == NAMES


@pytest.mark.parametrize("version", [(3, 0), (4, 1)])
def test_damaged_datagrams_end_in_a_sentence_or_in_poses(version: tuple[int, int]) -> None:
    whole = [frame(1.0, [rigid_body(7, (1.0, 2.0, 3.0))] * 3, version), descriptions(version)]
    said = []
    for seed in range(300):
        chance = np.random.default_rng(seed)
        damaged = bytearray(whole[seed % 2])
        for _ in range(3):
            damaged[chance.integers(len(damaged))] = chance.integers(256)
        content = bytes(damaged[: chance.integers(len(damaged)) if seed % 3 == 0 else None])
        try:
            (read_frame, rigid_body_names)[seed % 2](split(content)[1], version)
        except ClientError as error:
            said.append(str(error))
    assert said
    assert all("NatNet" in sentence for sentence in said)


@pytest.fixture
def server() -> Iterator[NatNetServer]:
    with NatNetServer() as server:
        yield server


class Sender:
    """Sends frames 10 ms apart, each 0.1 m further, until it is told to end; use it as a context manager.

    Attributes:
        sent: how many.
        tracked: whether the cameras see the hand.
    """

    def __init__(self, server: NatNetServer) -> None:
        self.sent, self.tracked = 0, True
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
            self._server.send(hand_frame(self.sent * PERIOD, 0.125 * self.sent, tracked=self.tracked))


def hand_frame(seconds: float, x: float, *, tracked: bool = True) -> bytes:
    return frame(seconds, [rigid_body(3, (0.0, 0.0, 0.0)), rigid_body(7, (x, 0.0, 0.5), tracked=tracked)])


def options(server: NatNetServer, **more: str) -> dict[str, str]:
    return {"server": server.address, "body": "hand", "wait": "300", "silence": "300"} | more


def gathered(stream: Iterator[HandReading], enough: Callable[[HandReading], bool]) -> list[HandReading]:
    """Return readings up to the first one for which `enough` is true."""
    found = [next(stream)]
    while not enough(found[-1]):
        found.append(next(stream))
    return found


@pytest.mark.parametrize("body", ["hand", "7"])
def test_a_body_is_followed_by_its_name_and_by_its_number(server: NatNetServer, body: str) -> None:
    server.swallow = 1  # a question that is lost is asked again
    with Sender(server) as sender, open_source("natnet", options(server, body=body)) as source:
        stream = iter(source)
        first = next(stream)
        sender.tracked = False
        last = gathered(stream, lambda reading: not reading.tracked)[-1]
        wait_until(lambda: server.kept_alive, "it is told that somebody listens")
    assert first.orientation == (1.0, 0.0, 0.0, 0.0)
    assert first.device_ns is not None
    assert last.device_ns is not None
    frames = round((last.position[0] - first.position[0]) / 0.125)
    assert last.device_ns - first.device_ns == pytest.approx(frames * PERIOD * 1e9, abs=2)


def test_what_comes_again_and_out_of_turn_is_left_out(server: NatNetServer) -> None:
    with Sender(server) as sender, open_source("natnet", options(server)) as source:
        stream = iter(source)
        next(stream)
        sender.__exit__()
        times = [1000.0 + number * PERIOD for number in range(5)]
        for place in (0, 0, 2, 1, 3, 4):
            server.send(hand_frame(times[place], 1000.0 + place))
        readings = gathered(stream, lambda reading: reading.position[0] == 1004.0)
    assert [each.position[0] - 1000.0 for each in readings if each.position[0] >= 1000.0] == [0.0, 2.0, 3.0, 4.0]


def test_a_server_that_was_started_anew_is_dated_anew(server: NatNetServer) -> None:
    days = itertools.count(1_700_000_000_000_000_000, 3_600_000_000_000)  # an hour later at each look
    settings = NatNetSettings(server.address, "hand", wait=300.0, silence=300.0)
    with NatNetSource(settings, time_of_day=lambda: next(days)) as source:
        stream, stamps = iter(source), []
        for seconds in (100.0, 100.01, 0.5, 0.51):
            server.send(hand_frame(seconds, seconds))
            stamps.append(next(stream).device_ns)
    assert [stamp - 1_700_000_000_000_000_000 for stamp in stamps if stamp] == [
        0,
        10_000_000,
        3_600_000_000_000,
        3_600_010_000_000,
    ]


def test_a_torn_datagram_makes_it_ask_anew(server: NatNetServer, caplog: pytest.LogCaptureFixture) -> None:
    with Sender(server), open_source("natnet", options(server)) as source:
        stream = iter(source)
        before = next(stream)
        server.send(hand_frame(1e6, 1e6)[:50])
        wait_until(lambda: server.connections == 2, "it is asked anew")
        after = gathered(stream, lambda reading: reading.time > before.time)[-1]
    assert after.position[0] > before.position[0]
    assert "trying again until it is back" in caplog.text


def test_a_server_that_is_silent_is_asked_anew(server: NatNetServer) -> None:
    with open_source("natnet", options(server, silence="0.2")):
        wait_until(lambda: server.connections >= 2, "it is asked anew")


@pytest.mark.parametrize(
    ("version", "sentence"), [((2, 10), "Motive speaks NatNet 2.10; 3.0 is the first"), ((0, 0), "NatNet 0.0")]
)
def test_an_old_server_is_refused(version: tuple[int, int], sentence: str) -> None:
    with (
        NatNetServer(version) as server,
        pytest.raises(ClientError, match=sentence),
        open_source("natnet", options(server)),
    ):
        pass


def test_a_body_that_is_not_there_is_said_with_those_that_are(server: NatNetServer) -> None:
    sentence = r"has no rigid body glove; it has: hand \(7\), table \(3\)"
    with pytest.raises(ClientError, match=sentence), open_source("natnet", options(server, body="glove")):
        pass


def test_nobody_and_a_port_that_is_none_are_said(server: NatNetServer) -> None:
    server.swallow = 10**9
    looks = itertools.count()  # time goes on by a second whenever it is looked at
    silent = NatNetSource(NatNetSettings(server.address, "hand"), clock=lambda: float(next(looks)))
    with pytest.raises(ClientError, match="does not answer; does Motive stream there"), silent:
        pass
    with pytest.raises(ClientError, match="'http' is no port"):
        open_source("natnet", {"server": "127.0.0.1:http", "body": "hand"})


def test_who_is_no_server_of_natnet_is_said(server: NatNetServer) -> None:
    with pytest.raises(ClientError, match=r"a datagram of 5 bytes is none of NatNet"):
        split(b"hello")
    assert split(datagram(7, b"abc")) == (7, b"abc")
