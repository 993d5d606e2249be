"""Many trackers at one recorder, paced as live: losses, CPU and latency, beside a Zenoh subscriber that only counts."""

import json
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import zenoh

from teachpath.commands.serving import free_port, short_pauses
from teachpath.io.bus import Bus, BusSettings, listen_on_bus
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.recorder.recorder import Recorder
from teachpath.recorder.recording_setup import Lookup
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, RecordingRequest, StopRequest
from teachpath_proto import tracker_pb2
from tests.bench import crowd
from tests.bench.report import Figure

TRACKERS = 400
PROCESSES = 4
TASK = "load"
BARE_SUBSCRIBER = "a bare Zenoh subscriber"


def measure(*, seconds: float) -> list[Figure]:
    """Return the figures of `TRACKERS` trackers at 50 Hz that each show one demonstration of `seconds`."""
    with tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder, short_pauses():  # as the service
        sent, lost, demonstrations, cpu, backlog, transits = _record(folder, seconds)
    counted_cpu, counted_transits = _count(seconds)
    what = f"{TRACKERS} trackers at {crowd.RATE:g} Hz for {seconds:g} s"
    p50, p99, worst = (1e3 * float(v) for v in np.percentile(transits, [50, 99, 100]))
    bare50, bare99 = (1e3 * float(v) for v in np.percentile(counted_transits, [50, 99]))
    return [
        Figure(f"{what}: samples lost", (lost,), f"of {sent:,}"),
        Figure(f"{what}: demonstrations made", (demonstrations,), f"of {TRACKERS}"),
        Figure("latency, sent to received, p50", (p50,), "ms", f"{BARE_SUBSCRIBER}: {bare50:.2f} ms", p50 / bare50),
        Figure("latency, sent to received, p99", (p99,), "ms", f"{BARE_SUBSCRIBER}: {bare99:.2f} ms", p99 / bare99),
        Figure("latency, sent to received, longest", (worst,), "ms"),
        Figure(
            "largest backlog behind the callback",
            (backlog,),
            "samples",
            f"a second brings {TRACKERS * crowd.RATE:,.0f}",
            backlog / (TRACKERS * crowd.RATE),
        ),
        Figure(
            "CPU of the recorder's process",
            (100.0 * cpu,),
            "% of a core",
            f"{BARE_SUBSCRIBER}: {100.0 * counted_cpu:.0f} %",
            cpu / counted_cpu,
        ),
    ]


def _record(folder: str, seconds: float) -> tuple[int, float, float, float, float, np.ndarray]:
    settings = BusSettings(endpoint=f"tcp/127.0.0.1:{free_port()}")
    bus = listen_on_bus(settings)
    try:
        with _recorder(bus, folder) as (recorder, store):
            bus.serve(crowd.RECEIVED_KEY, lambda _: b"")
            for number in range(TRACKERS):
                recorder.begin(RecordingRequest(TASK, crowd.name(number), scene="empty"))
            with _watched(recorder) as backlogs:
                cpu, sent = _crowd(settings.endpoint, seconds)
                ended = [recorder.end(StopRequest(crowd.name(n), sent)) for n in range(TRACKERS)]
            counted = [status.statistics for status in ended if status.statistics is not None]
            lost = sum(s.lost for s in counted) + sum(sent - s.received - s.lost for s in counted)
            made = sum(len(status.demonstrations) for status in ended)
            return sent * TRACKERS, float(lost), float(made), cpu, float(max(backlogs)), _transits(store)
    finally:
        bus.close()


@contextmanager
def _recorder(bus: Bus, folder: str) -> Iterator[tuple[Recorder, Store]]:
    store = Store(StoreSettings(data_dir=folder))
    settings = RecordingSettings(handshake_timeout=60.0)
    lookup = Lookup(scene=lambda _: empty_scene(), calibration=Calibration)
    recorder = Recorder(bus, crowd.KEYS, store, settings, lookup)
    recorder.start()
    try:
        yield recorder, store
    finally:
        recorder.stop()
        store.close()


def _transits(store: Store) -> np.ndarray:
    return np.array(
        [
            (sample.receive_ns - sample.device_ns) * 1e-9
            for row in store.demonstrations(TASK)
            for sample in store.recordings.samples(row.recording)
        ]
    )


@contextmanager
def _watched(recorder: Recorder) -> Iterator[list[int]]:
    """Look ten times a second how many samples wait."""
    backlogs, over = [0], threading.Event()

    def watch() -> None:
        while not over.wait(0.1):
            backlogs.append(recorder.backlog)

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        yield backlogs
    finally:
        over.set()
        thread.join()


def _count(seconds: float) -> tuple[float, np.ndarray]:
    """Return the CPU, in cores, of a process that only takes the same samples, and their latencies [s]."""
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    config = zenoh.Config()
    for key, value in {"mode": "peer", "listen/endpoints": [endpoint], "scouting/multicast/enabled": False}.items():
        config.insert_json5(key, json.dumps(value))
    taken: list[tuple[bytes, int]] = []
    session = zenoh.open(config)
    try:
        session.declare_queryable(crowd.RECEIVED_KEY, lambda query: query.reply(crowd.RECEIVED_KEY, b""))
        session.declare_subscriber(
            crowd.KEYS.all_samples, lambda sample: taken.append((sample.payload.to_bytes(), time.time_ns()))
        )
        cpu, _ = _crowd(endpoint, seconds)
    finally:
        session.close()  # type: ignore[no-untyped-call]
    sent = [tracker_pb2.HandSample.FromString(payload).device_ns for payload, _ in taken]
    return cpu, (np.array([at for _, at in taken]) - np.array(sent)) * 1e-9


def _crowd(endpoint: str, seconds: float) -> tuple[float, int]:
    """Let the trackers send; returns our CPU in cores meanwhile, and how many samples each has sent."""
    share = TRACKERS // PROCESSES
    began, cpu = time.monotonic(), time.process_time()
    processes = []
    for i in range(PROCESSES):
        words = [sys.executable, str(Path(crowd.__file__)), endpoint, str(i * share), str(share), str(seconds)]
        processes.append(subprocess.Popen(words, stdout=subprocess.PIPE, text=True))
    try:
        sent = [int(process.communicate(timeout=seconds + 150)[0]) for process in processes]
    finally:
        for process in processes:
            with suppress(ProcessLookupError):
                process.kill()
    if len(set(sent)) != 1:
        raise SystemExit(f"bench: the trackers sent {sent} samples each; the figures would be wrong")
    return (time.process_time() - cpu) / (time.monotonic() - began), sent[0]
