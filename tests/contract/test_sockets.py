"""The WebSockets of trackers and joints on a real port, with the friends and the foes that come there."""

import json
import threading
import time
from contextlib import suppress
from socket import SHUT_RDWR
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from teachpath.api.live_messages import JointMessage
from teachpath.app import Station
from teachpath.io.wire import encode_sample, encode_state
from teachpath.records import JointState
from tests.contract.desk import Desk, refused
from tests.contract.test_rest_work import planned
from tests.unit.recording.hands import demonstration, sample
from tests.waiting import HANG, wait_until

START = (0.58, -0.28, 0.52)  # of the object in the paper's scene


def come(port: int, name: str, query: str = "", **options: Any) -> ClientConnection:
    return connect(f"ws://127.0.0.1:{port}/api/v1/trackers/{name}/samples{query}", **options)


def ask(socket: ClientConnection, order: Any) -> dict[str, Any]:
    socket.send(order if isinstance(order, str) else json.dumps(order))
    answer: dict[str, Any] = json.loads(socket.recv(timeout=HANG))
    return answer


def closed(socket: ClientConnection) -> str:
    """Read until the service closes; return its reason."""
    with suppress(ConnectionClosed):
        while True:
            socket.recv(timeout=HANG)
    assert socket.close_reason is not None
    return socket.close_reason


def there(station: Station, name: str) -> bool:
    return any(tracker.name == name and tracker.announced for tracker in station.recorder.trackers())


def recorded(station: Station, name: str, count: int) -> None:
    """Wait until the recorder has come so far; the station of these tests waits only briefly at the end."""

    def received() -> int:
        statuses = station.recorder.statuses(with_statistics=True)
        return sum(s.statistics.received for s in statuses if s.tracker == name and s.statistics is not None)

    wait_until(lambda: received() >= count, f"{count} samples of {name} are recorded")


def test_a_page_shows_a_demonstration_and_ends_with_the_handshake(desk: Desk, port: int) -> None:
    desk.put("/tasks/socket", {"scene": "paper"})
    with come(port, "page-1") as socket:
        assert ask(socket, {"ping": 12.5})["pong"] == 12.5
        wait_until(lambda: there(desk.station, "page-1"), "the page is there")
        assert desk.post("/tasks/socket/recording", {"tracker": "page-1"}).status_code == 201
        stream = demonstration(at=START)
        for s in stream:
            socket.send(encode_sample(s))
        recorded(desk.station, "page-1", len(stream))
        report = ask(socket, {"end": len(stream)})["report"]
        assert (report["received"], report["lost"], len(report["demonstrations"])) == (len(stream), 0, 1)
        before = time.time_ns()
        pong = ask(socket, {"ping": 1})
        assert pong["samples"] == {"passed": len(stream), "refused": 0}
        assert before <= pong["service_ns"] <= time.time_ns()
        assert "not being recorded" in ask(socket, {"end": 1})["refused"]
    (shown,) = desk.get("/tasks/socket/demonstrations").json()
    assert (shown["verdict"], shown["source"]) == ("clean", "page-1")
    wait_until(lambda: not there(desk.station, "page-1"), "the page has gone")


@pytest.mark.parametrize(
    ("order", "sentence"),
    [
        ('{"sample": {"sequence": 1, "device_ns": 1, "position": {"x": NaN}}}', "not finite"),
        ('{"sample": {"sequence": 1e99}}', "no HandSample"),
        ('{"sample": 7}', "no message of a tracker"),
        ('{"ping": NaN}', "no message of a tracker"),
        ('{"ping": "x"}', "no message of a tracker"),
        ('{"end": -1}', "no message of a tracker"),
        ("[" * 60_000, "no message of a tracker"),
        ("x" * 70_000, "no message of a tracker"),
        ("", "no message of a tracker"),
        ('{"sample": {"\\ud800": 1}}', "no HandSample"),
    ],
)
def test_nonsense_is_answered_with_a_sentence_and_the_next_message_counts(port: int, order: str, sentence: str) -> None:
    with come(port, "page-2") as socket:
        assert sentence in ask(socket, order)["refused"]
        assert ask(socket, {"ping": 1})["samples"]["refused"] == 1


def test_samples_that_come_out_of_order_and_twice_are_accounted_for(desk: Desk, port: int) -> None:
    desk.put("/tasks/disorder", {"scene": "paper"})
    with come(port, "page-3") as socket:
        desk.post("/tasks/disorder/recording", {"tracker": "page-3"})
        stream = demonstration(at=START)
        sent = [*stream[:50], stream[51], stream[50], stream[51], stream[10], *stream[53:]]
        for s in sent:
            socket.send(encode_sample(s))
        recorded(desk.station, "page-3", len(sent))
        report = ask(socket, {"end": len(stream)})["report"]
        assert (report["reordered"], report["duplicated"], report["lost"]) == (1, 2, 1)


def test_a_flood_keeps_nobody_from_being_answered(port: int) -> None:
    with come(port, "page-4") as flood, come(port, "page-5") as calm:
        payload = encode_sample(sample(1, START))

        def pour() -> None:
            with suppress(ConnectionClosed):
                for _ in range(2500):
                    flood.send(payload)

        pouring = threading.Thread(target=pour)
        pouring.start()
        for k in range(20):
            assert ask(calm, {"ping": k})["pong"] == k
        pouring.join()
        # A machine that takes in over 1000 a second closes it; on a slower one the flood itself is slowed down.
        with suppress(ConnectionClosed):
            flood.send('{"ping": 1}')
            assert json.loads(flood.recv(timeout=HANG))["samples"]["passed"] == 2500
        assert flood.close_reason is None or "faster than 1000 a second" in flood.close_reason


def test_nonsense_without_end_is_closed(port: int) -> None:
    with come(port, "page-6") as socket:
        for _ in range(102):
            socket.send(b"\xff")
        assert "101 messages in a row were refused" in closed(socket)


def test_foreign_pages_bad_names_and_taken_names_are_refused(desk: Desk, port: int) -> None:
    for origin in ("http://elsewhere.example", "null"):
        for resource in ("trackers/page-7/samples", "joints"):
            with pytest.raises(InvalidStatus) as error:
                connect(f"ws://127.0.0.1:{port}/api/v1/{resource}", origin=origin)  # type: ignore[arg-type]
            assert error.value.response.status_code == 403
    with come(port, "..%20x") as socket:
        assert "cannot name a tracker" in closed(socket)
    token = desk.station.bus.announce(desk.station.keys.alive("tracker", "real"))
    wait_until(lambda: there(desk.station, "real"), "the tracker is there")
    with come(port, "real") as socket:
        assert "a tracker real is there already" in closed(socket)
    token.close()


def test_a_name_belongs_to_who_is_connected_and_only_its_session_comes_back(port: int) -> None:
    with come(port, "page-8", "?session=mine") as first:
        for other in ("", "?session=yours", "?session="):
            with come(port, "page-8", other) as second:
                assert "page-8 is connected already" in closed(second)
        assert ask(first, {"ping": 1})["pong"] == 1
        with come(port, "page-8", "?session=mine") as again:
            assert closed(first) == "page-8 has connected again"
            assert ask(again, {"ping": 1})["pong"] == 1


def test_a_page_that_breaks_off_is_seen_to_have_gone(desk: Desk, port: int) -> None:
    desk.put("/tasks/broken", {"scene": "paper"})
    with come(port, "page-9") as socket:
        wait_until(lambda: there(desk.station, "page-9"), "the page is there")
        desk.post("/tasks/broken/recording", {"tracker": "page-9"})
        for s in demonstration(at=START)[:45]:
            socket.send(encode_sample(s))
        recorded(desk.station, "page-9", 45)
        socket.socket.shutdown(SHUT_RDWR)  # no closing handshake
    wait_until(lambda: not there(desk.station, "page-9"), "the page has gone")
    wait_until(lambda: len(desk.get("/tasks/broken/demonstrations").json()) == 1, "the take has ended")
    (shown,) = desk.get("/tasks/broken/demonstrations").json()
    assert (shown["verdict"], shown["reasons"][0]) == ("reject", "the tracker has gone in mid-take")
    desk.post("/tasks/broken/recording/stop", {"tracker": "page-9"})


# the arm


def publish(station: Station, stamp: int, angle: float) -> None:
    zero = np.zeros(6)
    state = JointState(stamp, 1, zero + angle, zero, zero, 0.0, 0, False, True, (0.0,) * 3, (0.0,) * 4)
    station.bus.publish(station.keys.state("puma560"), encode_state(state))


def test_joint_states_come_decimated_and_the_newest_wins(desk: Desk, port: int) -> None:
    with connect(f"ws://127.0.0.1:{port}/api/v1/joints") as socket:
        began = time.monotonic()
        for k in range(200):
            publish(desk.station, k, k / 1000)
            time.sleep(0.0025)
        frames = [json.loads(socket.recv(timeout=HANG))]
        while frames[-1]["stamp_ns"] < 199:
            frames.append(json.loads(socket.recv(timeout=HANG)))
        seconds = time.monotonic() - began
        assert len(frames) <= 25 * seconds + 2
        stamps = [frame["stamp_ns"] for frame in frames]
        assert stamps == sorted(set(stamps))
        assert frames[-1]["position"] == [0.199] * 6
        TypeAdapter(JointMessage).validate_python(frames[-1], extra="forbid")
        assert frames[-1]["status"] is None
        socket.send("hello")
        assert "nothing is expected here" in closed(socket)


def test_the_arm_is_described_and_an_uncertified_plan_is_not_shown(desk: Desk) -> None:
    arm = desk.get("/robot").json()
    assert len(arm["links"]) == len(arm["speed"]) == len(arm["home"]) == 6
    refused(desk.get("/plans/none/motion"), 404, "none")
    refused(desk.get(f"/plans/{planned(desk.station, 'forged')}/motion"), 422, "has changed since it was certified")
