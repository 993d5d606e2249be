"""Requests over real sockets, to a station that is not there: each is answered on the topic of reports."""

from collections.abc import Iterator

import pytest

from teachpath_client.ros2.follower import TrajectoryFollower
from teachpath_client.ros2.messages import DIAGNOSTICS, TRAJECTORY, decode
from teachpath_client.ros2.node import Node
from teachpath_client.ros2.plan_requests import PlanRequests
from teachpath_client.station import Station
from tests.unit.clients.ros2 import golden
from tests.unit.clients.ros2.peer import TYPES, RmwPeer
from tests.unit.clients.ros2.test_plan_requests import NAMES, asking, planned
from tests.waiting import wait_until

pytestmark = pytest.mark.system

REQUEST_TOPIC, REPORT_TOPIC = "/teachpath/follow_joint_trajectory", "/teachpath/execution"


@pytest.fixture
def peer() -> Iterator[RmwPeer]:
    """A peer beside a follower that hears it."""
    requests = PlanRequests(NAMES, {"plan-1": planned()})
    with RmwPeer() as peer, Node(peer.router) as node:
        nobody = Station("http://127.0.0.1:9")
        names = {"robot": "puma560", "asked": REQUEST_TOPIC, "reported": REPORT_TOPIC}
        with nobody, TrajectoryFollower(node, nobody, requests, **names, clock=lambda: golden.STAMP_NS):
            wait_until(
                lambda: any(f"/MS/%/%/teachpath/{REQUEST_TOPIC.replace('/', '%')}/" in t for t in peer.tokens()),
                "hears",
            )
            yield peer


def reports(peer: RmwPeer) -> list[bytes]:
    key = f"0{REPORT_TOPIC}/{TYPES[DIAGNOSTICS]}"
    return [content for each, content, _ in list(peer.heard) if each == key]


def sentences(peer: RmwPeer) -> list[str]:
    return [decode(DIAGNOSTICS, content).status[0].message for content in reports(peer)]


def answer(peer: RmwPeer, content: bytes) -> str:
    """Send a request until it is answered, and return the sentence of the newest report."""
    before = len(reports(peer))

    def answered() -> bool:  # what is sent before the subscription is known here is not seen
        peer.put(REQUEST_TOPIC, TRAJECTORY, content)
        return len(reports(peer)) > before

    wait_until(answered, "it is answered")
    return sentences(peer)[-1]


def test_a_message_that_is_none_is_refused_byte_by_byte(peer: RmwPeer) -> None:
    answer(peer, b"\1")
    assert reports(peer)[0] == golden.report("refused: 01 in front does not say that CDR follows")


def test_a_plan_that_the_station_cannot_begin_is_reported_and_counts_once(peer: RmwPeer) -> None:
    answer(peer, asking())
    said = wait_until(lambda: [each for each in sentences(peer) if "it came twice" not in each], "it is reported")
    assert ["no station at" in each for each in said] == [True]


def test_a_stop_that_nobody_confirms_is_not_hidden(peer: RmwPeer) -> None:
    assert answer(peer, asking(points=[])).startswith("NOT STOPPED: no station at")
