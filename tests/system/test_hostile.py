"""Peers that are broken or mean, on a real line: what is refused is named, and other takes are whole to the bit."""

import json
import random
import socket
import struct
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import zenoh
from mcap.reader import make_reader

from teachpath.io.wire import encode_sample
from teachpath_proto import tracker_pb2
from tests.system.lines import KEYS, Desk, desk, plain_session
from tests.unit.recording.hands import demonstration

pytestmark = pytest.mark.system

SAMPLE_COUNT = 110
RATE = 50.0
Payloads = list[bytes]
TORN_PAYLOADS: list[Callable[[random.Random], bytes]] = [
    lambda chance: b"",
    lambda chance: chance.randbytes(chance.randrange(1, 400)),
    lambda chance: json.dumps({"sequence": 1, "position": [0, 0, 0]}).encode(),
    lambda chance: bytes(chance.choice([4097, 10**6])),
    lambda chance: good(chance).SerializeToString()[: chance.randrange(1, 120)],
    lambda chance: good(chance).SerializeToString() + b"\x0a\xff" + chance.randbytes(20),
    lambda chance: flipped(good(chance).SerializeToString(), chance),
    lambda chance: changed(chance, "position", chance.choice([float("nan"), float("inf"), -float("inf"), 1e300])),
    lambda chance: changed(chance, "orientation", chance.choice([float("nan"), 5.0, 1e300])),
    lambda chance: gloved(chance, [chance.choice([float("nan"), -0.1, 1.1, float("inf")])] * 22),
    lambda chance: gloved(chance, [0.5] * chance.choice([1, 17, 19, 21, 23, 500])),
    lambda chance: stamped(chance.choice([0, -1, -(2**63)])),
    lambda chance: tracker_pb2.StartRecording(task="a\x00b/../c", tracker="*").SerializeToString(),
]


def good(chance: random.Random) -> tracker_pb2.HandSample:
    return tracker_pb2.HandSample.FromString(
        encode_sample(demonstration(chance.randrange(1, 10**6))[chance.randrange(SAMPLE_COUNT)])
    )


def flipped(content: bytes, chance: random.Random) -> bytes:
    torn = bytearray(content)
    for _ in range(chance.randrange(1, 8)):
        torn[chance.randrange(len(torn))] = chance.randrange(256)
    return bytes(torn)


def changed(chance: random.Random, part: str, value: float) -> bytes:
    message = good(chance)
    getattr(message, part).x = value
    return message.SerializeToString()


def gloved(chance: random.Random, flexions: list[float]) -> bytes:
    message = good(chance)
    del message.flexions[:]
    message.flexions.extend(flexions)
    return message.SerializeToString()


def stamped(device_ns: int) -> bytes:
    message = tracker_pb2.HandSample.FromString(encode_sample(demonstration()[0]))
    message.device_ns = device_ns
    return message.SerializeToString()


def shown(takes: int) -> Payloads:
    return [encode_sample(s) for i in range(takes) for s in demonstration(1 + i * SAMPLE_COUNT)]


def send(publisher: Any, payloads: Payloads) -> None:
    due = time.monotonic()
    for payload in payloads:
        publisher.put(payload)
        due += 1.0 / RATE / 4
        time.sleep(max(0.0, due - time.monotonic()))


def kept(here: Desk, task: str) -> Payloads:
    """Return the payloads of all files of a task, as they lie on the disk."""
    found: Payloads = []
    for row in here.store.demonstrations(task):
        with here.store.recordings.path(row.recording).open("rb") as stream:
            found += [m.data for _, _, m in make_reader(stream, validate_crcs=True).iter_messages(topics=["samples"])]
    return found


def with_a_calm_take(here: Desk, mischief: Callable[[], None]) -> None:
    """Record two takes of an honest tracker meanwhile, and hold their files against what was sent."""
    payloads = shown(2)
    here.begin("calm", "calm")
    with plain_session(here.port) as session:
        calm = threading.Thread(target=send, args=(session.declare_publisher(KEYS.samples("calm")), payloads))
        calm.start()
        mischief()
        calm.join()
        report = here.end("calm", len(payloads))
    assert (report.received, report.lost, report.refused, len(report.demonstrations)) == (len(payloads), 0, 0, 2)
    assert [d.verdict for d in here.store.demonstrations("calm")] == ["clean", "clean"]
    taken = kept(here, "calm")
    assert taken == payloads[: len(taken)]
    assert len(taken) == report.received - report.idle > 200


@pytest.mark.parametrize("seed", [1, 2])
def test_a_thousand_malformed_payloads_are_counted_and_named(tmp_path: Path, seed: int) -> None:
    chance = random.Random(seed)
    payloads = [TORN_PAYLOADS[i % len(TORN_PAYLOADS)](chance) for i in range(1000)]
    chance.shuffle(payloads)
    with desk(tmp_path) as here:
        here.begin("fuzz", "fuzz")

        def rain() -> None:
            with plain_session(here.port) as session:
                publisher = session.declare_publisher(
                    KEYS.samples("fuzz"), congestion_control=zenoh.CongestionControl.BLOCK
                )
                for payload in payloads:
                    publisher.put(payload)
                here.refused_or_received("fuzz", len(payloads))

        with_a_calm_take(here, rain)
        report = here.end("fuzz")
    assert report.received + report.refused == len(payloads)
    assert report.refused > 800
    for said in ("bytes is over the limit", "not finite", "no unit quaternion", "flexion", "device time"):
        assert any(said in note for note in report.notes), (said, report.notes)
    assert all(len(note) < 400 and note.isprintable() for note in report.notes)


def test_a_flood_at_a_hundred_times_the_rate_keeps_nobody_waiting(tmp_path: Path) -> None:
    flood = [encode_sample(s) for i in range(100) for s in demonstration(1 + i * SAMPLE_COUNT)]
    with desk(tmp_path, longest_backlog=2000) as here:
        here.begin("flood", "flood")
        deepest, reports = 0, []

        def pour() -> None:
            nonlocal deepest
            with plain_session(here.port) as session:
                publisher = session.declare_publisher(
                    KEYS.samples("flood"), congestion_control=zenoh.CongestionControl.BLOCK
                )
                due = time.monotonic()
                for payload in flood:
                    publisher.put(payload)
                    due += 1.0 / (100.0 * RATE)
                    time.sleep(max(0.0, due - time.monotonic()))
                    deepest = max(deepest, here.recorder.backlog)
                reports.append(here.end("flood", len(flood)))

        with_a_calm_take(here, pour)
    (report,) = reports
    assert report.received + report.lost == len(flood)
    assert deepest <= 2000 + 2 * SAMPLE_COUNT
    turned_away = any("came faster than they can be recorded" in note for note in report.notes)
    assert turned_away == (report.lost > 0)


def test_clients_that_stop_in_mid_message_or_speak_another_language_harm_nobody(tmp_path: Path) -> None:
    chance = random.Random(4)
    with desk(tmp_path) as here:
        open_lines: list[socket.socket] = []

        def stutter() -> None:
            for i in range(30):
                line = socket.create_connection(("127.0.0.1", here.port))
                open_lines.append(line)
                line.sendall([struct.pack("<H", 500) + bytes(20), b"GET / HTTP/1.1\r\n", chance.randbytes(3000)][i % 3])
                time.sleep(0.01)

        with_a_calm_take(here, stutter)
        for line in open_lines:
            line.close()


def test_names_that_are_no_names_are_never_recorded(tmp_path: Path) -> None:
    with desk(tmp_path) as here:

        def call_names() -> None:
            with plain_session(here.port) as session:
                for name in ("a\x01b", "ü", "x" * 500, "..", "a b", "a\nb", "-"):
                    session.put(KEYS.samples(name), shown(1)[0])
                session.put(f"{KEYS.prefix}/trackers/a/b/samples", shown(1)[0])
                time.sleep(0.2)

        with_a_calm_take(here, call_names)
        assert [t.name for t in here.recorder.trackers() if t.name != "calm"] == []
        assert sorted(f.name for f in tmp_path.rglob("recordings/*")) == ["calm"]
