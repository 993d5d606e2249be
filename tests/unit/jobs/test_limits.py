"""What a job may take: memory, time, patience when it is cancelled, and a place in the queue."""

import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest

from teachpath.errors import QueueFull
from teachpath.io.store.store import Store
from teachpath.jobs.settings import JobSettings
from teachpath.records import JobState
from tests.unit.jobs.test_jobs import HANG, Bench

SETTINGS = JobSettings(attempts=2, max_memory=256 * 2**20)


def devour(word: str, *, progress: Callable[[float, str], None]) -> str:
    return word + str(len(bytearray(2**30)))


def hang(word: str, *, progress: Callable[[float, str], None]) -> str:
    progress(0.5, "hanging")
    time.sleep(HANG)
    return word


def repeat(word: str, *, progress: Callable[[float, str], None]) -> str:
    return word


@pytest.fixture
def open_bench(store: Store) -> Iterator[Callable[..., Bench]]:
    opened: list[Bench] = []

    def opener(settings: JobSettings = SETTINGS, **files: Callable[..., str]) -> Bench:
        opened.append(Bench(store, settings, files=files, devour=devour, hang=hang))
        opened[-1].jobs.start()
        return opened[-1]

    yield opener
    for bench in opened:
        bench.jobs.stop()


@pytest.mark.skipif(sys.platform != "linux", reason="the system cannot limit what a process takes from now on")
def test_a_job_that_takes_too_much_memory_fails_with_the_limit_and_the_next_one_runs(
    open_bench: Callable[..., Bench],
) -> None:
    bench = open_bench()
    for kind in ("devour", "echo"):
        bench.jobs.submit("t", kind, {"word": "x"})
    failed, fine = (bench.ended.get(timeout=HANG) for _ in range(2))
    assert failed.state is JobState.FAILED
    assert "over 268435456 bytes of memory, the limit; give it less, or raise the setting" in failed.message
    assert fine.state is JobState.SUCCEEDED


def test_a_job_that_takes_too_long_is_ended_and_the_next_one_runs(open_bench: Callable[..., Bench]) -> None:
    bench = open_bench(replace(SETTINGS, max_duration=0.5))
    bench.jobs.submit("t", "hang", {"word": "x"})
    failed = bench.ended.get(timeout=HANG)
    assert failed.state is JobState.FAILED
    assert "it takes over 0.5 s, the limit" in failed.message


def test_a_cancelled_job_that_hangs_is_ended(open_bench: Callable[..., Bench]) -> None:
    bench = open_bench()
    running = bench.jobs.submit("t", "hang", {"word": "x"})
    while bench.store.job(running.id).state is not JobState.RUNNING:
        time.sleep(0.01)
    bench.jobs.cancel(running.id)
    assert bench.ended.get(timeout=HANG).state is JobState.CANCELLED


def test_files_do_not_wait_for_learning(open_bench: Callable[..., Bench]) -> None:
    bench = open_bench(repeat=repeat)
    learning = bench.jobs.submit("t", "linger", {"word": "x"})
    file = bench.jobs.submit("t", "repeat", {"word": "y"})
    assert bench.ended.get(timeout=HANG).id == file.id
    assert bench.store.job(learning.id).state is not JobState.SUCCEEDED


def test_the_queue_has_a_limit_for_everybody_and_one_for_each(open_bench: Callable[..., Bench]) -> None:
    bench = open_bench(replace(SETTINGS, max_queued=5, max_queued_by_one=3))
    jobs = [bench.jobs.submit("t", "linger", {"word": "x"}, "ann") for _ in range(3)]
    with pytest.raises(QueueFull, match=r"3 jobs of ann wait or run, limit 3 \(jobs.max_queued_by_one\); wait until"):
        bench.jobs.submit("t", "linger", {"word": "x"}, "ann")
    for _ in range(2):
        bench.jobs.submit("t", "linger", {"word": "x"}, "bob")
    with pytest.raises(QueueFull, match=r"5 jobs wait or run, limit 5 \(jobs.max_queued\)"):
        bench.jobs.submit("t", "linger", {"word": "x"}, "cy")
    bench.jobs.cancel(jobs[2].id)
    bench.jobs.submit("t", "linger", {"word": "x"}, "ann")
    assert len(bench.store.jobs()) == 6
