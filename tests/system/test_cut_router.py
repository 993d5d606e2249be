"""A router beside the trackers whose line to the recorder is cut for 5 s: what is sent again, and what is counted."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import zenoh

from teachpath.records import Sample
from teachpath_client import Link
from teachpath_client.link import CACHE_SIZE
from tests.ports import free_endpoint
from tests.system.lines import KEYS, Desk, desk, publish, stretches
from tests.system.proxy import Proxy
from tests.unit.recording.hands import demonstration
from tests.waiting import wait_until

pytestmark = pytest.mark.system

CUT = 5.0  # [s]
SAMPLE_COUNT = 110
SLOW_LINK, FAST_LINK = 60.0, 400.0  # [Hz]: a tracker, and one that sends more in that time than its publisher keeps
WAIT_TIMEOUT = 20.0  # [Hz]


@contextmanager
def router(port: int) -> Iterator[str]:
    """A router that joins the recorder; returns where trackers join it."""
    endpoint = free_endpoint()
    document = {
        "mode": "router",
        "listen": {"endpoints": [endpoint]},
        "connect": {
            "endpoints": [f"tcp/127.0.0.1:{port}"],
            "timeout_ms": -1,
            "exit_on_failure": False,
            "retry": {"period_init_ms": 200, "period_max_ms": 200},
        },
        "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
    }
    session = zenoh.open(zenoh.Config.from_json5(json.dumps(document)))
    try:
        yield endpoint
    finally:
        session.close()  # type: ignore[no-untyped-call]


class Glove:
    """A tracker that shows one demonstration after another."""

    def __init__(self, name: str, link: Link, here: Desk) -> None:
        self._name, self._here, self.sent = name, here, 0
        self._publisher: Any = link.publisher(KEYS.samples(name))
        here.begin(name, name)

    def send(self, count: int, rate: float) -> None:
        stream: list[Sample] = []
        for first in range(self.sent // SAMPLE_COUNT, (self.sent + count) // SAMPLE_COUNT + 1):
            stream += demonstration(1 + first * SAMPLE_COUNT)
        publish(self._publisher, [s for s in stream if self.sent < s.sequence <= self.sent + count], rate=rate)
        self.sent += count

    @property
    def received(self) -> int:
        return self._here.report(self._name).received

    def reach(self) -> None:
        """Send until the recorder hears, and not so often that the publisher would forget."""
        before = self.received

        def heard() -> bool:
            self.send(1, WAIT_TIMEOUT)
            return self.received > before

        wait_until(heard, f"{self._name} is heard", pause=lambda _: None)


def test_what_the_publisher_still_has_comes_after_the_cut_and_what_it_has_not_is_counted(tmp_path: Path) -> None:
    with (
        desk(tmp_path) as here,
        Proxy(here.port) as proxy,
        router(proxy.port) as endpoint,
        Link(endpoint) as one,
        Link(endpoint) as other,
    ):
        slow, fast = Glove("slow", one, here), Glove("fast", other, here)
        for glove in (slow, fast):
            glove.reach()
        before = {glove: glove.sent for glove in (slow, fast)}
        proxy.drop(cut=True)
        sending = threading.Thread(target=fast.send, args=(int(CUT * FAST_LINK), FAST_LINK))
        sending.start()
        slow.send(int(CUT * SLOW_LINK), SLOW_LINK)
        sending.join()
        assert {glove: glove.sent - before[glove] for glove in (slow, fast)} == {slow: 300, fast: 2000}
        proxy.go_on()
        for glove in (slow, fast):
            glove.reach()
            glove.send(2 * SAMPLE_COUNT, FAST_LINK)
        told = {glove: here.end(name, glove.sent) for name, glove in (("slow", slow), ("fast", fast))}
    assert (told[slow].lost, stretches(told[slow])) == (0, [])
    assert told[slow].received == slow.sent
    assert told[fast].received + told[fast].lost == fast.sent
    assert told[fast].lost > 0
    assert len(stretches(told[fast])) == 1  # the oldest of them
    assert fast.sent - before[fast] - told[fast].lost >= CACHE_SIZE
