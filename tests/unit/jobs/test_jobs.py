import os
import queue
import signal
import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import pytest

from teachpath.errors import Conflict, LearningFailed, PathRefused
from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.store import Store
from teachpath.jobs.executors import Work
from teachpath.jobs.jobs import JobKind, Jobs
from teachpath.jobs.settings import JobSettings
from teachpath.records import Failure, Job, JobState, Suggestion
from teachpath_proto.keys import Keys
from tests.waiting import HANG

KEYS = Keys("test")
SETTINGS = JobSettings(attempts=2)
FAILURE = Failure("reach", 0.1, (0.1, 0.2), (0.5, 0.0, 0.5), "too far", Suggestion(3, (0.0, 0.0, -0.01), "lower it"))


def echo(word: str, *, progress: Callable[[float, str], None]) -> str:
    progress(0.5, "half")
    return word


def refuse(word: str, *, progress: Callable[[float, str], None]) -> str:
    raise LearningFailed(f"cannot learn {word}", "demonstration-7")


def block(word: str, *, progress: Callable[[float, str], None]) -> str:
    raise PathRefused(f"cannot follow {word}", FAILURE)


def crash(word: str, *, progress: Callable[[float, str], None]) -> str:
    os.kill(os.getpid(), signal.SIGKILL)
    return word


def linger(word: str, *, progress: Callable[[float, str], None]) -> str:
    while True:  # until it is cancelled, or its process ended
        progress(0.5, "waiting")
        time.sleep(0.05)


def fault(word: str, *, progress: Callable[[float, str], None]) -> str:
    raise ZeroDivisionError(word)


class Bench:
    """Jobs that work on words; `ended` gives them as they end."""

    def __init__(
        self,
        store: Store,
        settings: JobSettings = SETTINGS,
        *,
        files: Mapping[str, Callable[..., str]] | None = None,
        **instead: Callable[..., str],
    ) -> None:
        self.store, self.bus = store, MemoryBus()
        self.ended: queue.Queue[Job] = queue.Queue()
        self.outcomes: list[str] = []
        works = {f.__name__: f for f in (echo, refuse, block, crash, linger, fault)} | instead
        kinds = {name: JobKind(self.prepare, Work(work), self.finish) for name, work in works.items()}
        kinds |= {name: JobKind(self.prepare, Work(work), self.finish, "files") for name, work in (files or {}).items()}
        self.jobs = Jobs(self.bus, KEYS, store, settings, kinds, on_finished=self.ended.put)

    def prepare(self, job: Job) -> tuple[Any, ...]:
        return (job.request["word"],)

    def finish(self, job: Job, outcome: str) -> str:
        self.outcomes.append(outcome)
        now = time.time_ns()
        self.store.set_job(job.id, state="succeeded", outcome=outcome, fraction=1.0, finished_ns=now)
        return outcome


@pytest.fixture
def bench(store: Store) -> Iterator[Bench]:
    bench = Bench(store)
    bench.jobs.start()
    yield bench
    bench.jobs.stop()


def test_jobs_run_in_their_order_and_keep_their_outcome(bench: Bench) -> None:
    submitted = [bench.jobs.submit("t", "echo", {"word": w}) for w in ("a", "b", "c")]
    ended = [bench.ended.get(timeout=HANG) for _ in submitted]
    assert [job.id for job in ended] == [job.id for job in submitted]
    assert [job.outcome for job in ended] == ["a", "b", "c"]
    assert all(job.attempt == 1 and job.state is JobState.SUCCEEDED for job in ended)


def test_a_refusal_keeps_its_sentence_and_a_fault_is_named(bench: Bench) -> None:
    bench.jobs.submit("t", "refuse", {"word": "x"})
    bench.jobs.submit("t", "fault", {"word": "boom"})
    bench.jobs.submit("t", "echo", {"word": "after"})
    refused, faulted, fine = (bench.ended.get(timeout=HANG) for _ in range(3))
    assert (refused.state, refused.message) == (JobState.FAILED, "cannot learn x")
    assert faulted.state is JobState.FAILED
    assert "ZeroDivisionError('boom')" in faulted.message
    assert fine.state is JobState.SUCCEEDED


def test_a_refusal_keeps_the_record_that_it_carries(bench: Bench) -> None:
    for kind in ("refuse", "block", "echo"):
        bench.jobs.submit("t", kind, {"word": "x"})
    refused, blocked, fine = (bench.ended.get(timeout=HANG) for _ in range(3))
    assert (refused.demonstration, refused.failure) == ("demonstration-7", None)
    assert (blocked.demonstration, blocked.failure) == ("", FAILURE)
    assert (fine.demonstration, fine.failure) == ("", None)
    assert bench.store.job(blocked.id).failure == FAILURE


def test_a_job_whose_process_dies_is_begun_anew_then_given_up(bench: Bench) -> None:
    bench.jobs.submit("t", "crash", {"word": "x"})
    bench.jobs.submit("t", "echo", {"word": "after"})
    ended = {job.kind: job for job in (bench.ended.get(timeout=HANG) for _ in range(2))}
    assert ended["crash"].state is JobState.FAILED
    assert "died 2 times" in ended["crash"].message
    assert ended["echo"].state is JobState.SUCCEEDED


def test_running_and_queued_jobs_can_be_cancelled_and_ended_ones_not(bench: Bench) -> None:
    progress: queue.Queue[bytes] = queue.Queue()
    running = bench.jobs.submit("t", "linger", {"word": "x"})
    queued = bench.jobs.submit("t", "linger", {"word": "y"})
    bench.bus.subscribe(KEYS.job(running.id), lambda _, payload: progress.put(payload))
    progress.get(timeout=HANG)
    assert bench.jobs.cancel(queued.id).state is JobState.CANCELLED
    bench.jobs.cancel(running.id)
    assert {bench.ended.get(timeout=HANG).id for _ in range(2)} == {queued.id, running.id}
    assert bench.store.job(running.id).state is JobState.CANCELLED
    with pytest.raises(Conflict, match="already cancelled"):
        bench.jobs.cancel(running.id)


def test_a_job_survives_a_restart_and_is_done_once(store: Store) -> None:
    first = Bench(store)
    first.jobs.start()
    heard: queue.Queue[bytes] = queue.Queue()
    running = first.jobs.submit("t", "linger", {"word": "x"})
    waiting = first.jobs.submit("t", "echo", {"word": "w"})
    first.bus.subscribe(KEYS.job(running.id), lambda _, payload: heard.put(payload))
    heard.get(timeout=HANG)
    first.jobs.stop()
    assert [job.id for job in store.jobs(unfinished=True)] == [running.id, waiting.id]

    second = Bench(store, linger=echo)
    second.jobs.start()
    ended = [second.ended.get(timeout=HANG) for _ in range(2)]
    second.jobs.stop()
    assert [(job.id, job.state.value, job.attempt) for job in ended] == [
        (running.id, "succeeded", 1),
        (waiting.id, "succeeded", 1),
    ]
    assert second.outcomes == ["x", "w"]
    assert store.jobs(unfinished=True) == []
