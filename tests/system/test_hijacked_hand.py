"""A hand that leads the arm is copied by other programs under its name: they move nothing, and the operator is told."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import pytest
import zenoh
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from teachpath.io.wire import decode_state
from teachpath_client import HandReading, Link, Station
from teachpath_client.errors import ClientError, Refused
from teachpath_client.models import Execution
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Role, find_login
from teachpath_proto.sessions import joining, open_session
from tests.system.operators import RELEASE_CLUTCH_REASON, STARVED_REASONS
from tests.system.processes import Service, stop_arm
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

KEYS = Keys()
CLUTCH = 4
STILL_TOLERANCE = 1e-3  # [rad] that an arm at rest gives way


class Hand:
    """A hand that stands still with its clutch open, or pressed while it leads."""

    def __init__(self) -> None:
        self.pressed, self.place = False, (0.0, 0.0, 0.0)
        self._gone, self._thread = threading.Event(), threading.Thread(target=self._show)
        self.put = lambda payload: None

    def __enter__(self) -> "Hand":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._gone.set()
        self._thread.join(HANG)

    def _show(self) -> None:
        number = 0
        while not self._gone.wait(0.02):
            number += 1
            reading = HandReading(number * 0.02, self.place, buttons=CLUTCH if self.pressed else 0)
            self.put(reading.message(number, 1).SerializeToString())


def leads(hand: Hand, station: Station, execution: str) -> bool:
    """Press a hand's clutch and tell whether it leads the arm.

    Where a busy machine made the executor hold the arm, it resumes, and the clutch is let go and pressed again.
    """
    status = station.get_execution(execution).status
    if status.state == "held" and status.reason.startswith(STARVED_REASONS):
        with suppress(Refused):  # it goes on by itself meanwhile
            station.steer(execution, "resume")
    hand.pressed = not status.reason.startswith(RELEASE_CLUTCH_REASON)
    return status.state == "following"


def moves(hand: Hand, station: Station, execution: str, positions: list[np.ndarray]) -> bool:
    """Take the hand 3 cm aside or back while it leads the arm, and tell whether the arm moves."""
    if leads(hand, station, execution):
        hand.place = (0.0, 0.03 - hand.place[1], 0.02)
    before = len(positions)
    wait_until(lambda: len(positions) > before + 20, "the arm speaks on")
    return bool(np.ptp(positions[before:], axis=0).max() > STILL_TOLERANCE)


@contextmanager
def hand(service: Service, tracker: str, *, plain: bool = False) -> Iterator[Hand]:
    """Show a hand to a station, by the client's own session or by a plain publisher of Zenoh."""
    shown = Hand()
    if plain:
        login = find_login(service.endpoint, Role.TRACKER)
        session = open_session(joining(service.endpoint, login, timeout=HANG))
        publisher = session.declare_publisher(KEYS.samples(tracker), congestion_control=zenoh.CongestionControl.BLOCK)
        shown.put = publisher.put
        with session, shown:
            yield shown
        return
    with Link(service.endpoint) as link:
        shown.put = link.publisher(KEYS.samples(tracker)).put
        with shown:
            yield shown


def test_another_session_under_the_name_of_the_leading_hand_moves_nothing(tmp_path: Path) -> None:
    with Service(tmp_path / "data") as service, Link(service.endpoint, role=Role.OPERATOR) as viewer:
        positions: list[np.ndarray] = []
        viewer.subscribe(KEYS.state("puma560"), lambda payload: positions.append(decode_state(payload).position))
        station, url = service.station, f"{service.url.replace('http', 'ws')}/api/v1/trackers/glove/samples"
        station.wait_for_arm(timeout=HANG)
        with hand(service, "plain", plain=True):
            wait_until(lambda: any(t.name == "plain" for t in station.health().trackers), "its samples come")
            with pytest.raises(ClientError, match="samples as plain name no session"):
                station.begin_teleoperation("plain", scene="empty")
        with hand(service, "glove") as leader:
            led = station.begin_teleoperation("glove", scene="empty")

            def now() -> Execution:
                return station.get_execution(led.id)

            wait_until(lambda: "press the clutch" in now().status.reason, "the arm waits for the clutch")
            wait_until(lambda: leads(leader, station, led.id), "the hand leads")
            leader.pressed = False
            wait_until(lambda: now().status.state == "held", "the arm rests")
            with hand(service, "glove") as copy, hand(service, "glove", plain=True) as stranger:
                wait_until(lambda: "another session sends as glove" in now().status.activity, "the copy is noticed")
                before = len(positions)
                for other in (copy, stranger):
                    other.pressed, other.place = True, (0.0, 0.15, 0.1)
                wait_until(lambda: len(positions) > before + 100, "the arm speaks on")
                assert np.ptp(positions[before:], axis=0).max() < STILL_TOLERANCE
                assert now().status.state == "held"
                told = lambda: any("two sessions send samples as glove" in note for note in station.health().notes)  # noqa: E731
                wait_until(told, "health says so, too")
                with connect(url) as socket, pytest.raises(ConnectionClosed, match="glove is there already"):
                    socket.recv(timeout=HANG)
            wait_until(lambda: leads(leader, station, led.id), "the hand itself still leads")
            wait_until(lambda: moves(leader, station, led.id, positions), "the arm follows it")
        stop_arm(station, led.id)
