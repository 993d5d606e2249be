"""A take of half an hour: how long its end takes, and the answer with its trajectory."""

import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from statistics import median

from teachpath.commands.serving import short_pauses
from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.recorder.recorder import Recorder
from teachpath.recorder.recording_setup import Lookup
from teachpath.recorder.recording_work import encode_trajectory
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, RecordingRequest, StopRequest
from teachpath_client.synthetic import RATE, experiment_1
from teachpath_proto.keys import Keys
from tests.bench.report import Figure

SECONDS = 1800
TRACKER = "glove"
KEYS = Keys("bench")
CLOSED_FLEXION = 0.9  # flexion
POINTS = 2000  # of the trajectory that a page asks for
LONGEST_STOP, LONGEST_ANSWER = 1000.0, 300.0  # [ms] that are aimed at


def measure(*, repeats: int) -> list[Figure]:
    """Return the figures of a take in which the hand carries all the time."""
    with short_pauses():  # as the service
        stops, answers = zip(*(_take() for _ in range(repeats)), strict=True)
    what = f"a take of {SECONDS / 60:g} min at {RATE:g} Hz"
    return [
        Figure(f"{what}: from stop to its row", stops, "ms", f"aim: {LONGEST_STOP:g} ms", median(stops) / LONGEST_STOP),
        Figure(
            f"{what}: its trajectory, read and encoded",
            answers,
            "ms",
            f"aim: {LONGEST_ANSWER:g} ms",
            median(answers) / LONGEST_ANSWER,
        ),
    ]


def _take() -> tuple[float, float]:
    with tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder:
        store, bus = Store(StoreSettings(data_dir=folder)), MemoryBus()
        lookup = Lookup(scene=lambda _: empty_scene(), calibration=Calibration)
        settings = RecordingSettings(handshake_timeout=60.0, longest_backlog=1_000_000)
        recorder = Recorder(bus, KEYS, store, settings, lookup)
        recorder.start()
        try:
            recorder.begin(RecordingRequest("long", TRACKER, scene="empty"))
            for payload in _payloads():
                bus.publish(KEYS.samples(TRACKER), payload)
            while recorder.backlog:
                time.sleep(0.05)
            began = time.perf_counter()
            recorder.end(StopRequest(TRACKER))
            stop = time.perf_counter() - began
            (row,) = store.demonstrations("long")
            began = time.perf_counter()
            encode_trajectory(store.recordings, row, None, POINTS)
            return 1e3 * stop, 1e3 * (time.perf_counter() - began)
        finally:
            recorder.stop()
            store.close()


def _payloads() -> Iterator[bytes]:
    """Yield the samples of a hand that carries along the paper's ways, closed all the time."""
    hand, start_ns = list(experiment_1()), time.time_ns()
    for i in range(round(SECONDS * RATE)):
        reading = hand[i % len(hand)]
        closed = replace(reading, time=i / RATE, flexions=(CLOSED_FLEXION,) * len(reading.flexions))
        yield closed.message(i + 1, start_ns).SerializeToString()
