"""Takes that are completed later: nothing of them is lost meanwhile, and they keep their order."""

import threading
from collections.abc import Callable
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

from teachpath.io.store.salvage import salvage
from teachpath.io.store.store import Store
from teachpath.recorder.closed_take import TakeQueue
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.row_queue import RowQueue
from teachpath.recorder.session import RecordingSession
from teachpath.recorder.take import FinishedTake
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Routine
from tests.unit.recorder.recorders import SCENE
from tests.unit.recording.hands import demonstration

SAMPLE_COUNT = 110  # samples of a demonstration, of which some come after its end


class Later(Executor):
    """Runs what was submitted when the test says so."""

    def __init__(self) -> None:
        self._submitted: list[Callable[[], Any]] = []

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **named: Any) -> Any:
        self._submitted.append(lambda: function(*arguments, **named))

    def run(self) -> None:
        submitted, self._submitted = self._submitted, []
        for call in submitted:
            call()


def recorded_later(store: Store, later: Later, routine: Routine) -> tuple[RecordingSession, list[FinishedTake]]:
    finished: list[FinishedTake] = []
    store.ensure_task("lift", scene="paper", calibration="identity")
    setup = RecordingSetup("lift", "glove", Calibration("identity"), SCENE, routine=routine)
    queue = TakeQueue(later, threading.Condition(), finished.append, RowQueue(store))
    return RecordingSession(store, RecordingSettings(), setup, completer=queue), finished


def closed_file(store: Store) -> Path:
    """Return the file of the take that waits; that of the next one is small."""
    return max(store.recordings.unfinished(), key=lambda file: file.stat().st_size)


def test_what_waits_to_be_completed_survives_the_process(store: Store) -> None:
    session, finished = recorded_later(store, later := Later(), Routine())
    shown = demonstration()
    assert [session.add(sample) for sample in shown] == [None] * SAMPLE_COUNT
    samples = salvage(closed_file(store))[1]
    session.finish()
    later.run()
    ((row, _),) = finished
    assert len(samples) == row.samples
    assert [row.id] == session.demonstrations
    assert store.recordings.unfinished() == []


def test_takes_are_completed_in_their_order_and_counted_when_they_end(store: Store) -> None:
    session, finished = recorded_later(store, later := Later(), Routine(takes=3))
    for take in range(2):
        for sample in demonstration(1 + take * SAMPLE_COUNT):
            session.add(sample)
    assert session.status().takes_left == 1
    assert session.demonstrations == []
    session.finish()
    later.run()
    assert [row.number for row, _ in finished] == [1, 2]


def test_a_take_that_cannot_be_kept_counts_no_more(store: Store) -> None:
    session, finished = recorded_later(store, later := Later(), Routine(takes=3))
    for sample in demonstration():
        session.add(sample)
    closed_file(store).unlink()  # so that it cannot be renamed
    session.finish()
    later.run()
    assert (finished, session.status().takes_left, session.status().idle) == ([], 3, SAMPLE_COUNT)
    assert any("cannot be finished" in note for note in session.counter.statistics().notes)
