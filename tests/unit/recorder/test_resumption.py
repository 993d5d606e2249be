"""A service that is stopped while it records: the next one goes on, and its takes are what they would have been."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from teachpath.io.store.store import Store
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Demonstration, Sample
from tests.unit.recorder.recorders import KEYS, Bench
from tests.unit.recording.hands import START_NS, demonstration
from tests.waiting import wait_until

SAMPLE_COUNT = 110
GRASP_SAMPLE, RELEASE_SAMPLE = 20, 70  # of the take that is shown, as indices
MISSED_SAMPLES = 15  # samples that the tracker sends while no service runs


@pytest.fixture
def bench(store: Store) -> Iterator[Bench]:
    bench = Bench(store)
    bench.begin()
    yield bench
    bench.recorder.stop()


@contextmanager
def restarted(before: Bench, missed: list[Sample] | None = None) -> Iterator[Bench]:
    """Stop a recorder and start another one; its tracker has stayed, and sends `missed` while there is none."""
    before.recorder.stop()
    before.send(missed or [])
    after = Bench(before.store, bus=before.bus)
    try:
        yield after
    finally:
        after.recorder.stop()


def announce(bench: Bench) -> None:
    bench.bus.announce(KEYS.alive("tracker", "glove"))


def carried(bench: Bench, made: Demonstration) -> np.ndarray:
    path = bench.recorder.annotations.trajectory(made)
    return np.column_stack([path.times, path.positions])


def endings(bench: Bench) -> list[str]:
    return sorted("".join(f.suffixes) for f in bench.store.recordings.folder("lift").parent.rglob("*") if f.is_file())


@pytest.mark.parametrize(
    "stop",
    [0, 12, GRASP_SAMPLE, GRASP_SAMPLE + 1, RELEASE_SAMPLE - MISSED_SAMPLES, RELEASE_SAMPLE - 1, RELEASE_SAMPLE + 1],
)
def test_a_take_that_a_restart_interrupts_is_what_it_would_have_been(bench: Bench, stop: int) -> None:
    stream, on = demonstration(), stop + MISSED_SAMPLES
    announce(bench)
    bench.send(stream[:stop])
    with restarted(bench, stream[stop:on]) as after:
        after.send(stream[on:])
        assert len(after.end(SAMPLE_COUNT).demonstrations) == 1
        after.begin(task="whole")
        after.send(demonstration(SAMPLE_COUNT + 1))
        after.end(2 * SAMPLE_COUNT)
        (made,), (whole,) = after.store.demonstrations("lift"), after.store.demonstrations("whole")
        assert made.verdict == whole.verdict == "clean"
        assert (made.statistics.lost, made.statistics.duplicated, made.statistics.reordered) == (0, 0, 0)
        np.testing.assert_allclose(carried(after, made), carried(after, whole), atol=1e-9)
        assert endings(after) == [".mcap", ".mcap"]


def test_what_nobody_has_kept_is_lost_and_said(bench: Bench) -> None:
    stream, stop = demonstration(), GRASP_SAMPLE + 5
    announce(bench)
    bench.send(stream[:stop])
    with restarted(bench) as after:
        after.send(stream[stop + MISSED_SAMPLES :])
        after.end(SAMPLE_COUNT)
        (made,) = after.store.demonstrations("lift")
        assert (made.verdict, made.statistics.lost) == ("reject", MISSED_SAMPLES)


def test_two_restarts_in_one_take_lose_nothing_either(bench: Bench) -> None:
    stream = demonstration()
    announce(bench)
    bench.send(stream[:30])
    with restarted(bench, stream[30:40]) as first:
        first.send(stream[40:45])
        with restarted(first, stream[45:55]) as second:
            second.send(stream[55:])
            assert len(second.end(SAMPLE_COUNT).demonstrations) == 1
            (made,) = second.store.demonstrations("lift")
            assert (made.verdict, made.statistics.lost) == ("clean", 0)


def test_a_tracker_that_counts_anew_makes_no_take_of_two(bench: Bench) -> None:
    stream = demonstration()
    bench.send(stream[:40])
    with restarted(bench) as after:
        announce(bench)
        late = START_NS + 60 * 10**9
        bench.send([s._replace(device_ns=s.device_ns + late - START_NS) for s in stream])
        wait_until(lambda: after.recorder.statuses()[0].demonstrations, "the take in the hand has ended")
        after.recorder.wait_for_takes()
        (made,) = after.store.demonstrations("lift")[:1]
        assert made.verdict == "reject"
        assert any("count anew" in reason for reason in made.reasons), made.reasons


def test_a_tracker_that_does_not_come_back_ends_its_take_and_may_be_recorded_anew(bench: Bench) -> None:
    bench.send(demonstration()[:40])
    with restarted(bench) as after:
        after.now = RecordingSettings().tracker_return_timeout + 1.0
        after.until(lambda report: report.state == "lost")
        (made,) = after.store.demonstrations("lift")
        assert made.verdict == "reject"
        assert any("did not come back" in reason for reason in made.reasons), made.reasons
        after.begin(task="other")


def test_who_begins_anew_meanwhile_ends_the_take_that_waits(bench: Bench) -> None:
    bench.send([s._replace(flexions=(), buttons=int(s.flexions[0] > 0.5)) for s in demonstration()[:40]])
    with restarted(bench) as after:
        after.begin(task="other")
        after.recorder.wait_for_takes()
        wait_until(lambda: after.store.demonstrations("lift"), "the take has ended")
        assert [made.verdict for made in after.store.demonstrations("lift")] == ["reject"]


def test_routine_pause_and_demonstrations_outlast_the_stop(store: Store) -> None:
    bench = Bench(store)
    announce(bench)
    bench.begin(takes=3, one_by_one=True)
    bench.send(demonstration())
    before = bench.received(SAMPLE_COUNT)
    with restarted(bench) as after:
        (report,) = after.reports()
        assert (report.state, report.takes_left) == (before.state, before.takes_left) == ("paused", 2)
        assert list(report.demonstrations) == list(before.demonstrations)


def test_a_start_that_is_broken_off_loses_and_doubles_nothing(bench: Bench, tmp_path: Path) -> None:
    stream = demonstration()
    announce(bench)
    bench.send(stream[:40])
    bench.recorder.stop()
    folder = bench.store.recordings.folder("lift").parent
    shutil.copytree(folder, tmp_path / "left")
    Bench(bench.store, bus=bench.bus).recorder.stop()  # it has written the take anew
    shutil.copytree(tmp_path / "left", folder, dirs_exist_ok=True)  # and removed nothing yet
    with restarted(bench, stream[40:60]) as after:
        after.send(stream[60:])
        assert len(after.end(SAMPLE_COUNT).demonstrations) == 1
        assert endings(after) == [".mcap"]
        assert after.store.demonstrations("lift")[0].verdict == "clean"


def test_a_take_whose_recording_cannot_go_on_is_left_for_the_doctor(bench: Bench) -> None:
    bench.send(demonstration()[:40])
    bench.recorder.stop()
    bench.store.task_changes.archive("lift")
    with restarted(bench) as after:
        assert after.reports() == []
        assert endings(after) == [".mcap.part"]
        assert any("does not go on" in fault for fault in after.store.health.faults())
