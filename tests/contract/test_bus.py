"""What every kind of bus must do, run on the real one and on the in-memory twin."""

import itertools
import queue
import threading
import time
from collections.abc import Iterator
from contextlib import suppress

import pytest

from teachpath.errors import Conflict, TeachpathError, Unanswered, Unreachable
from teachpath.io.bus import Bus, BusSettings, listen_on_bus, open_bus
from teachpath.io.memory_bus import MemoryBus
from teachpath_client import Link
from tests.ports import free_endpoint
from tests.waiting import HANG, wait_until


@pytest.fixture(params=["memory", "zenoh: one session", "zenoh: two clients of a peer"])
def ends(request: pytest.FixtureRequest) -> Iterator[tuple[Bus, Bus]]:
    """Two ends of one bus."""
    opened: list[Bus] = []
    if request.param == "memory":
        opened = [MemoryBus()]
    else:
        settings = BusSettings(endpoint=free_endpoint())
        opened.append(listen_on_bus(settings))
        if "two" in request.param:
            opened += [open_bus(settings), open_bus(settings)]
    yield opened[-1], opened[-2] if len(opened) > 1 else opened[-1]
    for bus in reversed(opened):
        bus.close()


def test_the_session_that_published_is_told(ends: tuple[Bus, Bus]) -> None:
    sender, receiver = ends
    came: queue.Queue[str] = queue.Queue()
    handle = receiver.subscribe_with_source("who/sent", lambda _, payload, source: came.put(source))
    while came.empty():  # until the sender's session knows who listens
        sender.publish("who/sent", b"")
        time.sleep(0.01)
    assert came.get() != ""
    handle.close()


def wait_reachable(asker: Bus, server: Bus) -> None:
    """Return once a declaration of `server` is known to `asker`."""
    handle = server.serve("t/ready", lambda _: b"yes")

    def answers() -> bool:
        with suppress(Unreachable):
            return bool(asker.ask("t/ready"))
        return False

    wait_until(answers, "the other end is heard")
    handle.close()


def test_delivers_in_order_to_matching_keys_only(ends: tuple[Bus, Bus]) -> None:
    here, there = ends
    got: queue.Queue[tuple[str, bytes]] = queue.Queue()
    there.subscribe("t/*/samples", lambda key, payload: got.put((key, payload)))
    wait_reachable(here, there)
    here.publish("t/a/other", b"no")
    here.publish("t/a/b/samples", b"no")
    for i in range(100):
        here.publish("t/a/samples", str(i).encode())
    assert [got.get(timeout=HANG) for _ in range(100)] == [("t/a/samples", str(i).encode()) for i in range(100)]
    assert got.empty()


def test_answers_queries_and_raises_the_servers_error(ends: tuple[Bus, Bus]) -> None:
    here, there = ends

    def answer(payload: bytes) -> bytes:
        if payload == b"busy":
            raise Conflict("the recorder is busy")
        return payload.upper()

    handle = there.serve("t/echo", answer)
    wait_reachable(here, there)
    assert here.ask("t/echo", b"abc") == b"ABC"
    with pytest.raises(Conflict, match="the recorder is busy"):
        here.ask("t/echo", b"busy")
    handle.close()
    handle.close()


def test_says_when_nobody_answers(ends: tuple[Bus, Bus]) -> None:
    with pytest.raises(Unreachable, match="nobody answered t/none"):
        ends[0].ask("t/none", timeout=0.3)


def test_says_when_who_is_there_has_not_answered_in_time() -> None:
    bus, answered = listen_on_bus(BusSettings(endpoint=free_endpoint())), threading.Event()

    def answer(payload: bytes) -> bytes:
        answered.wait()
        return payload

    bus.serve("t/slow", answer)
    with pytest.raises(Unanswered, match=r"t/slow was not answered within 0.2 s"):
        bus.ask("t/slow", timeout=0.2)
    answered.set()
    bus.close()


def test_shows_who_is_alive(ends: tuple[Bus, Bus]) -> None:
    here, there = ends
    seen: queue.Queue[tuple[str, bool]] = queue.Queue()
    token = here.announce("t/alive/glove")
    there.watch("t/alive/**", lambda key, alive: seen.put((key, alive)))
    assert seen.get(timeout=HANG) == ("t/alive/glove", True)
    token.close()
    assert seen.get(timeout=HANG) == ("t/alive/glove", False)


def test_a_closed_subscription_is_silent(ends: tuple[Bus, Bus]) -> None:
    here, there = ends
    got: queue.Queue[bytes] = queue.Queue()
    keep: queue.Queue[bytes] = queue.Queue()
    handle = there.subscribe("t/x", lambda _, payload: got.put(payload))
    there.subscribe("t/x", lambda _, payload: keep.put(payload))
    wait_reachable(here, there)
    here.publish("t/x", b"1")
    assert got.get(timeout=HANG) == keep.get(timeout=HANG) == b"1"
    handle.close()
    here.publish("t/x", b"2")
    assert keep.get(timeout=HANG) == b"2"
    assert got.empty()


def test_connecting_to_nobody_is_a_sentence() -> None:
    with pytest.raises(TeachpathError, match="is the service running there"):
        open_bus(BusSettings(endpoint=free_endpoint(), connect_timeout=0.3))


def test_a_taken_endpoint_is_a_sentence() -> None:
    settings = BusSettings(endpoint=free_endpoint())
    first = listen_on_bus(settings)
    with pytest.raises(Unreachable, match="taken"):
        listen_on_bus(settings)
    first.close()


def test_a_subscription_that_counts_what_it_missed_serves_plain_publishers_and_ends_with_its_session(
    ends: tuple[Bus, Bus],
) -> None:
    here, there = ends
    got: queue.Queue[tuple[bytes, str]] = queue.Queue()
    missed: list[int] = []

    def keep(_: str, payload: bytes, source: str) -> None:
        got.put((payload, source))

    handle = there.subscribe_with_source("t/*/samples", keep, missed=missed.append)
    wait_reachable(here, there)
    for i in range(200):
        here.publish("t/a/samples", str(i).encode())
    came = [got.get(timeout=HANG) for _ in range(200)]
    assert [payload for payload, _ in came] == [str(i).encode() for i in range(200)]
    assert len({source for _, source in came}) == 1
    assert came[0][1] != ""
    handle.close()
    here.publish("t/a/samples", b"late")
    there.subscribe_with_source("t/*/samples", keep, missed=missed.append)
    assert got.empty()
    assert missed == []


def test_what_a_client_sends_comes_once_and_in_order_from_the_first_that_comes() -> None:
    settings = BusSettings(endpoint=free_endpoint())
    bus = listen_on_bus(settings)
    got: queue.Queue[int] = queue.Queue()
    missed: list[int] = []
    try:
        with Link(settings.endpoint) as link:
            publisher, sent = link.publisher("t/a/samples"), itertools.count()
            bus.subscribe_with_source(
                "t/*/samples", lambda _, payload, source: got.put(int(payload)), missed=missed.append
            )
            while got.empty():
                publisher.put(str(next(sent)).encode())
            for _ in range(500):
                publisher.put(str(next(sent)).encode())
            last, seen = next(sent) - 1, [got.get(timeout=HANG)]
            while seen[-1] < last:
                seen.append(got.get(timeout=HANG))
            assert seen == list(range(seen[0], last + 1))
            assert missed == []
    finally:
        bus.close()
