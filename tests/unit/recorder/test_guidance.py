import threading
from dataclasses import replace

import numpy as np

from teachpath.errors import UnusableRecording
from teachpath.learning.settings import LearningSettings
from teachpath.recorder.guidance import GuidanceThread, course_of
from teachpath.records import Array, Demonstration, Trajectory
from tests.contract.rows import demonstration
from tests.waiting import HANG

SHOWN_SHARES = (0.0, 0.0, 0.3, 0.0, 0.0, 0.3)  # how far each demonstration swings out [m]


def stored(count: int = len(SHOWN_SHARES)) -> list[Demonstration]:
    return [demonstration(f"d{i}", number=i + 1) for i in range(count)]


def course(shown: Demonstration) -> Array:
    t = np.linspace(0.0, 1.0, 150)
    swing = SHOWN_SHARES[shown.number - 1] + 0.008 * np.sin(7.0 * shown.number)
    return course_of(Trajectory(3.0 * t, np.column_stack([0.6 * t, swing * np.sin(np.pi * t), np.full(150, 0.5)])))


def test_it_tells_the_ways_apart_and_asks_for_the_one_that_is_thin() -> None:
    guidance = GuidanceThread(lambda _: stored(), course, LearningSettings())
    advice = guidance.compare("t")
    assert advice.startswith("6 demonstrations show 2 ways and agree within ")
    assert advice.endswith("; the second way has only two, show it again")


def test_discarded_marked_and_rejected_ones_do_not_count() -> None:
    changes = ({"discarded_ns": 5}, {"mark": "bad"}, {"verdict": "reject"})
    kept = [replace(d, **change) for d, change in zip(stored(3), changes, strict=True)]  # type: ignore[arg-type]
    assert GuidanceThread(lambda _: kept, course, LearningSettings()).compare("t") == ""
    assert "one demonstration" in GuidanceThread(lambda _: [*kept, stored()[3]], course, LearningSettings()).compare(
        "t"
    )


def test_each_demonstration_is_read_once_and_again_when_it_was_trimmed() -> None:
    read: list[tuple[str, tuple[int, int]]] = []
    rows = stored()

    def reading(shown: Demonstration) -> Array:
        read.append((shown.id, shown.transport))
        return course(shown)

    guidance = GuidanceThread(lambda _: rows, reading, LearningSettings())
    guidance.compare("t")
    guidance.compare("t")
    assert len(read) == len(rows)
    rows[2] = replace(rows[2], trim=(2, 3))
    guidance.compare("t")
    assert read[len(rows) :] == [(rows[2].id, (2, 3))]


def test_it_answers_from_its_own_thread_and_outlives_what_cannot_be_read() -> None:
    asked, answered = threading.Semaphore(0), threading.Semaphore(0)

    def rows(task: str) -> list[Demonstration]:
        asked.release()
        if task == "broken":
            raise UnusableRecording("recording t/d0.mcap is damaged")
        answered.release()
        return stored(1)

    guidance = GuidanceThread(rows, course, LearningSettings())
    guidance.start()
    assert guidance.advice("t") == ""
    guidance.request("broken")
    assert asked.acquire(timeout=HANG)
    guidance.request("t")
    assert answered.acquire(timeout=HANG)
    guidance.stop()
    assert guidance.advice("t") == "one demonstration so far; show it again"
    assert "damaged" in guidance.advice("broken")
    guidance.stop()


def test_of_a_burst_every_task_is_compared() -> None:
    done, asked = threading.Event(), []

    def rows(task: str) -> list[Demonstration]:
        asked.append(task)
        if len(asked) == 2:
            done.set()
        return stored(1)

    guidance = GuidanceThread(rows, course, LearningSettings())
    for task in ("a", "b", "a"):
        guidance.request(task)
    guidance.start()
    assert done.wait(timeout=HANG)
    guidance.stop()
    assert asked == ["a", "b"]
    assert set(guidance.all_advice()) == {"a", "b"}
