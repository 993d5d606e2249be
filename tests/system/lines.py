"""A recorder on a real Zenoh socket in this process, and clients that reach it over a line that can be made bad."""

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import zenoh

from teachpath.io.bus import BusSettings, listen_on_bus
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.io.wire import encode_recording_status, encode_sample
from teachpath.recorder.recorder import Recorder
from teachpath.recorder.recording_setup import Lookup
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, RecordingRequest, RecordingStatus, Sample, Scene, Shape, StopRequest
from teachpath_client import Link
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys
from tests.ports import free_ports
from tests.system.proxy import Proxy
from tests.waiting import wait_until

KEYS = Keys("line")
SCENE = Scene("table", (), Shape("block", "box", (0.04, 0.04, 0.04), (0.5, 0.0, 0.5)))
Report = tracker_pb2.RecordingReport


def report_of(status: RecordingStatus) -> Report:
    return Report.FromString(encode_recording_status(status))


class Desk:
    """A recorder that listens."""

    def __init__(self, folder: Path, settings: RecordingSettings) -> None:
        (self.port,) = free_ports(1)
        self.bus = listen_on_bus(BusSettings(endpoint=f"tcp/127.0.0.1:{self.port}"))
        self.store = Store(StoreSettings(data_dir=str(folder)))
        self.recorder = Recorder(self.bus, KEYS, self.store, settings, Lookup(lambda _: SCENE, Calibration))
        self.recorder.start()

    def begin(self, tracker: str, task: str) -> None:
        self.recorder.begin(RecordingRequest(task, tracker, scene="table"))

    def report(self, tracker: str) -> Report:
        (found,) = (s for s in self.recorder.statuses(with_statistics=True) if s.tracker == tracker)
        return report_of(found)

    def end(self, tracker: str, last: int | None = None) -> Report:
        return report_of(self.recorder.end(StopRequest(tracker, last)))

    def received(self, tracker: str, count: int) -> None:
        wait_until(lambda: self.report(tracker).received >= count, f"{count} samples of {tracker} are recorded")

    def refused_or_received(self, tracker: str, count: int) -> None:
        counted = lambda: self.report(tracker).received + self.report(tracker).refused >= count  # noqa: E731
        wait_until(counted, f"{count} payloads of {tracker} are counted")

    def close(self) -> None:
        self.recorder.stop()
        self.bus.close()
        self.store.close()


@contextmanager
def desk(folder: Path, **settings: Any) -> Iterator[Desk]:
    """A recorder with patience: no tracker is lost because the machine was slow."""
    opened = Desk(folder, RecordingSettings(**{"longest_silence": 60.0, "handshake_timeout": 20.0, **settings}))
    try:
        yield opened
    finally:
        opened.close()


@contextmanager
def bad_line(desk: Desk) -> Iterator[tuple[Proxy, Link]]:
    """A client of ours behind a proxy."""
    with Proxy(desk.port) as proxy, Link(f"tcp/127.0.0.1:{proxy.port}") as link:
        try:
            yield proxy, link
        finally:
            proxy.go_on()


@contextmanager
def plain_session(port: int) -> Iterator[Any]:
    """A Zenoh client of somebody else's, without a cache."""
    config = zenoh.Config()
    for path, value in {
        "mode": "client",
        "connect/endpoints": [f"tcp/127.0.0.1:{port}"],
        "scouting/multicast/enabled": False,
    }.items():
        config.insert_json5(path, json.dumps(value))
    session = zenoh.open(config)
    try:
        yield session
    finally:
        session.close()  # type: ignore[no-untyped-call]


def publish(publisher: Any, samples: list[Sample], *, rate: float = 0.0) -> None:
    """Publish samples, at `rate` [Hz] or as fast as they go."""
    due = time.monotonic()
    for sample in samples:
        publisher.put(encode_sample(sample))
        if rate:
            due += 1.0 / rate
            time.sleep(max(0.0, due - time.monotonic()))


def stretches(report: Report) -> list[tuple[int, int]]:
    return [(m.first, m.last) for m in report.missing]
