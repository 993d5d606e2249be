"""A page or the guidance may stall; the recorder goes on."""

import threading

import numpy as np

from teachpath.errors import UnusableRecording
from teachpath.learning.settings import LearningSettings
from teachpath.live.preview.preview import Preview
from teachpath.motion.arm.geometry import visual_solids
from teachpath.motion.arm.model import Arm
from teachpath.recorder.guidance import GuidanceThread
from teachpath.records import Array, Demonstration
from tests.unit.recorder.recorders import KEYS, Bench
from tests.unit.recording.hands import demonstration
from tests.waiting import HANG

SAMPLE_COUNT = 110
TAKES = 8


def record(bench: Bench) -> None:
    bench.begin()
    for pop in range(TAKES):
        bench.send(demonstration(1 + pop * SAMPLE_COUNT))
    report = bench.end(TAKES * SAMPLE_COUNT)
    assert (report.received, report.lost, len(report.demonstrations)) == (TAKES * SAMPLE_COUNT, 0, TAKES)


def test_a_page_that_sleeps_does_not_delay_the_recorder(bench: Bench) -> None:
    view = Preview(
        bench.bus,
        KEYS,
        visual_solids(),
        arm=Arm.of_variant(),
        robot="puma",
        home=np.zeros(6),
        statuses=bench.recorder.shown_statuses,
    )
    with view:
        viewer = view.connect(lambda: None)
        assert viewer.pop()  # the first batch, which it never acknowledges
        record(bench)
        assert viewer.pending < 100


def test_guidance_that_stalls_does_not_delay_the_recorder(store: object) -> None:
    go_on, asked = threading.Event(), threading.Event()

    def stall(_: Demonstration) -> Array:
        asked.set()
        go_on.wait()
        raise UnusableRecording("nobody needs it any more")

    bench = Bench(store, recorded=lambda made, _: guidance.request(made.task))  # type: ignore[arg-type]
    guidance = GuidanceThread(bench.store.demonstrations, stall, LearningSettings())
    guidance.start()
    try:
        record(bench)
        assert asked.wait(HANG)
    finally:
        go_on.set()
        guidance.stop()
        bench.recorder.stop()


def test_a_take_that_takes_long_to_complete_delays_no_sample(store: object) -> None:
    go_on, asked = threading.Event(), threading.Event()

    def stall(made: Demonstration, _: object) -> None:
        if made.source == "slow":
            asked.set()
            go_on.wait()

    bench = Bench(store, recorded=stall)  # type: ignore[arg-type]
    try:
        for tracker in ("slow", "glove"):
            bench.begin(tracker)
        bench.send(demonstration(), "slow")
        assert asked.wait(HANG)
        bench.send(demonstration(), "glove")
        bench.send(demonstration(1 + SAMPLE_COUNT), "slow")
        assert len(bench.end(SAMPLE_COUNT, "glove").demonstrations) == 1
        bench.until(lambda report: report.received == 2 * SAMPLE_COUNT, "slow", settled=False)
        go_on.set()
        assert len(bench.end(2 * SAMPLE_COUNT, "slow").demonstrations) == 2
    finally:
        go_on.set()
        bench.recorder.stop()
