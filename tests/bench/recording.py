"""Samples a second through the recorder into MCAP files, in one process and over Zenoh, beside a bare subscriber."""

import json
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from typing import Any

import zenoh

from teachpath.commands.serving import free_port, short_pauses
from teachpath.io.bus import Bus, BusSettings, listen_on_bus
from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.recorder.queries import RecorderQueries
from teachpath.recorder.recorder import Recorder
from teachpath.recorder.recording_setup import DemonstrationCallbacks, Lookup
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Demonstration, RecordingRequest, StopRequest, Trajectory
from teachpath_client.synthetic import RATE
from tests.bench import sender
from tests.bench.report import Figure, against

DEMO = 4236  # samples of the demo's twelve demonstrations


def measure(*, repeats: int, samples: int) -> tuple[list[Figure], dict[str, Trajectory]]:
    """Return the figures, and the twelve trajectories that the recorder cut of the demo's samples."""
    _, trajectories = _through_memory(DEMO)
    memory, zenoh_, peer = [], [], []
    with short_pauses():  # as the service
        for _ in range(repeats):
            memory.append(_through_memory(samples)[0])
            zenoh_.append(_through_zenoh(samples))
            peer.append(_bare_subscriber(samples))
    bare = median(peer)
    return [
        against("recorder to MCAP, one process", memory, "samples/s", name="bare Zenoh subscriber", value=bare),
        against("recorder to MCAP, Zenoh client", zenoh_, "samples/s", name="bare Zenoh subscriber", value=bare),
        against("recorder to MCAP, Zenoh client", zenoh_, "samples/s", name="one tracker", value=RATE),
        Figure("bare Zenoh subscriber that counts", tuple(peer), "samples/s"),
    ], trajectories


def _through_memory(samples: int) -> tuple[float, dict[str, Trajectory]]:
    payloads = sender.payloads(samples)
    with _recorder(bus := MemoryBus()) as made:
        recorder = made[0]
        recorder.begin(RecordingRequest("bench", sender.TRACKER, scene="paper"))
        began = time.perf_counter()
        for payload in payloads:
            bus.publish(sender.KEYS.samples(sender.TRACKER), payload)
        statistics = recorder.end(StopRequest(sender.TRACKER, samples)).statistics
        seconds = time.perf_counter() - began
        assert statistics is not None
        _check(statistics.received, statistics.lost, samples)
        return samples / seconds, made[1]


def _through_zenoh(samples: int) -> float:
    settings = BusSettings(endpoint=f"tcp/127.0.0.1:{free_port()}")
    bus = listen_on_bus(settings)
    try:
        with _recorder(bus):
            return samples / _send("recorder", settings.endpoint, samples)
    finally:
        bus.close()


def _bare_subscriber(samples: int) -> float:
    """Count the same samples with nothing but Zenoh's own Python API."""
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    config = zenoh.Config()
    for key, value in {"mode": "peer", "listen/endpoints": [endpoint], "scouting/multicast/enabled": False}.items():
        config.insert_json5(key, json.dumps(value))
    counted, every = [0], threading.Event()

    def count(_: zenoh.Sample) -> None:
        counted[0] += 1
        if counted[0] == samples:
            every.set()

    session = zenoh.open(config)
    try:
        queries = session.declare_queryable(sender.COUNTED_KEY)
        session.declare_subscriber(sender.KEYS.samples(sender.TRACKER), count)
        answering = threading.Thread(target=_answer, args=(queries, every), daemon=True)
        answering.start()
        seconds = _send("subscriber", endpoint, samples)
        answering.join()
    finally:
        session.close()  # type: ignore[no-untyped-call]
    _check(counted[0], 0, samples)
    return samples / seconds


def _answer(queries: zenoh.Queryable[Any], every: threading.Event) -> None:
    with queries.recv() as query:
        every.wait(60.0)
        query.reply(sender.COUNTED_KEY, b"")


def _send(to: str, endpoint: str, samples: int) -> float:
    command = [sys.executable, str(Path(sender.__file__)), to, endpoint, str(samples)]
    return float(subprocess.run(command, check=True, capture_output=True, text=True, timeout=120).stdout)


@contextmanager
def _recorder(bus: Bus) -> Iterator[tuple[Recorder, dict[str, Trajectory]]]:
    """Run a recorder on `bus` with a store of its own; yields it and the trajectories that it cuts."""
    trajectories: dict[str, Trajectory] = {}

    def keep(demonstration: Demonstration, trajectory: Trajectory) -> None:
        trajectories[f"{demonstration.number:02}"] = trajectory

    with tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder:
        store = Store(StoreSettings(data_dir=folder))
        recorder = Recorder(
            bus,
            sender.KEYS,
            store,
            RecordingSettings(handshake_timeout=60.0),
            Lookup(scene=lambda _: paper_scene(), calibration=Calibration),
            DemonstrationCallbacks(added=keep),
        )
        queries = RecorderQueries(bus, sender.KEYS, recorder)
        recorder.start()
        queries.start()
        try:
            yield recorder, trajectories
        finally:
            queries.stop()
            recorder.stop()
            store.close()


def _check(received: int, lost: int, sent: int) -> None:
    if (received, lost) != (sent, 0):
        raise SystemExit(f"bench: {received} of {sent} samples arrived, {lost} were lost; the figures would be wrong")
