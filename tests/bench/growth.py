"""What one more demonstration, page or tracker costs when there are 1, 10, 100 and 1,000: make bench ARGS=scale.

Everything is measured in seconds of the processor, in this process, so that a busy machine says the same.
"""

import asyncio
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from httpx import ASGITransport, AsyncClient

from teachpath.app import Station
from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.live.event_hub import EventHub
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.recorder.recorder import Recorder
from teachpath.recorder.recording_setup import Lookup
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, RecordingRequest
from teachpath.web.settings import WebSettings
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys
from tests.bench.report import Figure, against, print_report
from tests.contract.rows import demonstration
from tests.contract.stations import settings
from tests.waiting import wait_until

SIZES = (1, 10, 100, 1000)
CHANGES = 20  # events of one measurement
SECOND = 50  # samples of one tracker
SOCKETS = 3  # WebSockets of a page
STOP_SHARE = 0.1  # of the connections, which is kept for a stop
KEYS = Keys("bench")


@dataclass(frozen=True)
class Growth:
    """What the whole costs at each size [s of the processor]."""

    what: str
    each: str
    totals: tuple[float, ...]

    @property
    def slope(self) -> float:
        """Exponent of the cost from 10 on: 1 is linear, more would be steeper; below, fixed costs hide it."""
        return float(np.polyfit(np.log(SIZES[1:]), np.log(self.totals[1:]), 1)[0])

    @property
    def one(self) -> float:
        """What one of the most costs [s]."""
        return self.totals[-1] / SIZES[-1]

    def figures(self) -> list[Figure]:
        """Return the cost of one at each size, and how the whole grows."""
        ones = [1e3 * total / size for total, size in zip(self.totals, SIZES, strict=True)]
        lines = [Figure(f"{self.what}, {size:,}", (one,), "ms each") for size, one in zip(SIZES, ones, strict=True)]
        return [*lines, against("  the whole grows with the power", [self.slope], "", name="linear", value=1.0)]


def growths() -> list[Growth]:
    """Measure each growth."""
    stored, listed = zip(*(_demonstrations(size) for size in SIZES), strict=True)
    return [
        Growth("a demonstration stored", "demonstration", stored),
        Growth("demonstrations listed, page by page", "demonstration", listed),
        Growth("an event put before all pages, and encoded", "page", tuple(_pages(size) for size in SIZES)),
        Growth("a second of all trackers recorded (50 Hz)", "tracker", tuple(_trackers(size) for size in SIZES)),
    ]


def limits(measured: list[Growth]) -> list[Figure]:
    """Return the first limit that each resource meets, by what was measured, and what to turn."""
    _, listed, _, trackers = measured
    pages = (1.0 - STOP_SHARE) * WebSettings().max_connections / SOCKETS
    return [
        Figure("trackers at 50 Hz on one core", (1.0 / trackers.one,), "", "another station on the same store"),
        Figure("open pages, by connections", (pages,), "", "web.max_connections"),
        Figure(
            "demonstrations listed in a second of one core", (1.0 / listed.one,), "", "a page of each list at a time"
        ),
    ]


def _processor(work: Callable[[], object]) -> float:
    began = time.process_time()
    work()
    return time.process_time() - began


def _demonstrations(count: int) -> tuple[float, float]:
    """Store some, and list them over REST in pages of 100."""
    with tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder:
        store = Store(StoreSettings(folder))
        store.ensure_task("t", scene="paper", calibration="identity")
        made = [demonstration(f"d{number:04d}") for number in range(count)]
        stored = _processor(lambda: [store.add_demonstration(each) for each in made])
        store.close()
        station = Station(settings(Path(folder)))
        try:
            return stored, asyncio.run(_listed(station, count))
        finally:
            station.__exit__(None, None, None)


async def _listed(station: Station, count: int) -> float:
    async with AsyncClient(transport=ASGITransport(station.web), base_url="http://127.0.0.1:8765") as client:
        await client.get("/api/v1/tasks/t/demonstrations?limit=1")  # what only the first request costs
        place, entries, began = "/api/v1/tasks/t/demonstrations?limit=100", 0, time.process_time()
        while place:
            answer = await client.get(place)
            entries += len(answer.raise_for_status().json())
            place = answer.links.get("next", {}).get("url", "")
        assert entries == count
        return time.process_time() - began


def _pages(count: int) -> float:
    """Tell a change to all pages, each of which takes it."""
    hub = EventHub()
    subscribers = [hub.subscribe(lambda: None) for _ in range(count)]
    for subscriber in subscribers:
        while subscriber.pop():
            pass

    def tell() -> None:
        for number in range(CHANGES):
            hub.publish_change("jobs", f"job-{number}")
            for subscriber in subscribers:
                event = subscriber.pop()
                assert event is not None
                event.text.encode()

    return _processor(tell) / CHANGES


def _trackers(count: int) -> float:
    """Record a second of each tracker, whose hand is open."""
    with tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder:
        store, bus = Store(StoreSettings(folder)), MemoryBus()
        lookup = Lookup(lambda _: empty_scene(), lambda _: Calibration("identity"))
        recorder = Recorder(bus, KEYS, store, RecordingSettings(), lookup)
        recorder.start()
        names = [f"glove-{number:04d}" for number in range(count)]
        for name in names:
            recorder.begin(RecordingRequest("t", name, scene="empty"))
        message = tracker_pb2.HandSample(tracked=True, flexions=[0.1] * 22)
        message.orientation.w = 1.0

        def record() -> None:
            for number in range(1, SECOND + 1):
                message.sequence, message.device_ns = number, number * 20_000_000
                for name in names:
                    bus.publish(KEYS.samples(name), message.SerializeToString())
            wait_until(lambda: recorder.backlog == 0, "all is recorded", pause=lambda _: time.sleep(0.05))

        seconds = _processor(record)
        recorder.stop()
        store.close()
        return seconds


def report() -> None:
    """Measure and print."""
    measured = growths()
    print_report("As a site grows", [figure for growth in measured for figure in growth.figures()])
    print_report("The first limit of each resource, and what to turn", limits(measured))


if __name__ == "__main__":
    report()
