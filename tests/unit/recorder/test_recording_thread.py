"""The rounds of the recording thread, one by one: which tracker waits for which, and when the thread pauses."""

from collections.abc import Callable, Iterator

import pytest

from teachpath.io.store.store import Store
from teachpath.io.wire import encode_sample
from teachpath.recorder.presence import Presence
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.recording_thread import BATCH_SIZE, FLUSH_INTERVAL, TURNS_IN_A_ROUND, RecordingThread
from teachpath.recorder.row_queue import RowQueue
from teachpath.recorder.sample_queues import SampleQueues
from teachpath.recorder.suspendable_session import SuspendableSession
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Scene
from tests.unit.recorder.recorders import KEYS
from tests.unit.recording.hands import sample

SETTINGS = RecordingSettings()


class Desk:
    """A recording thread whose rounds the test makes."""

    def __init__(self, store: Store, trackers: tuple[str, ...]) -> None:
        self.now = 0.0
        self.store = store
        self.meanwhile: Callable[[], None] = lambda: None  # what others do after a round has chosen whose turn it is
        presence = Presence(lambda: self.now)
        self.queues = SampleQueues(KEYS, presence, SETTINGS.longest_backlog)
        self.thread = RecordingThread(
            self.queues,
            presence,
            SETTINGS,
            on_finished=lambda finished: None,
            on_discard_request=lambda session: None,
            rows=RowQueue(store),
            clock=self._clock,
        )
        for tracker in trackers:
            self.begin(tracker)

    def _clock(self) -> float:
        self.meanwhile()
        return self.now

    def begin(self, tracker: str) -> None:
        setup = RecordingSetup("lift", tracker, Calibration("identity"), Scene("empty"))
        self.thread.sessions[tracker] = SuspendableSession(self.store, SETTINGS, setup, clock=lambda: self.now)
        self.queues.open(tracker)

    def send(self, tracker: str, count: int, first: int = 1) -> None:
        for n in range(first, first + count):
            self.queues.on_sample(KEYS.samples(tracker), encode_sample(sample(n, (0.0, 0.0, 0.0))))

    def recorded(self, tracker: str) -> int:
        return self.thread.sessions[tracker].counter.received


@pytest.fixture
def desk(store: Store) -> Iterator[Desk]:
    desk = Desk(store, ("left", "right"))
    yield desk
    desk.thread.stop()


def test_it_rests_only_when_no_batch_was_full(desk: Desk) -> None:
    desk.send("left", 2 * BATCH_SIZE + 50)
    assert [desk.thread.process_round() for _ in range(4)] == [True, True, False, False]
    assert desk.recorded("left") == 2 * BATCH_SIZE + 50
    assert desk.queues.backlog == 0


def test_samples_that_trickle_in_from_many_hurry_nobody(desk: Desk) -> None:
    for tracker in ("left", "right"):
        desk.send(tracker, BATCH_SIZE - 1)
    assert not desk.thread.process_round()


def test_a_flood_keeps_no_other_waiting_for_more_than_one_batch(desk: Desk) -> None:
    desk.send("left", 10 * BATCH_SIZE)
    desk.send("right", 1)
    assert desk.thread.process_round()
    assert (desk.recorded("left"), desk.recorded("right")) == (BATCH_SIZE, 1)


def test_a_flush_that_is_due_is_no_reason_to_hurry(desk: Desk) -> None:
    desk.now = 2 * FLUSH_INTERVAL
    assert not desk.thread.process_round()
    assert desk.thread.sessions["left"].last_flush == desk.now


def test_of_hundreds_each_has_its_turn_within_a_few_rounds(store: Store) -> None:
    trackers = tuple(f"glove-{i}" for i in range(2 * TURNS_IN_A_ROUND + 1))
    desk = Desk(store, trackers)
    counts = []
    for _ in range(6):
        for tracker in trackers:
            desk.send(tracker, 1)
        assert not desk.thread.process_round()
        counts.append([desk.recorded(tracker) for tracker in trackers])
    assert sum(counts[0]) == TURNS_IN_A_ROUND
    assert counts[2] == [1] * TURNS_IN_A_ROUND + [2] * TURNS_IN_A_ROUND + [3]
    assert min(counts[5]) == 4
    desk.thread.stop()


def test_a_recording_that_begins_while_the_one_before_has_its_turn_gets_its_own_samples(desk: Desk) -> None:
    desk.send("left", 1)  # so that it has a turn
    ended = desk.thread.sessions["left"]

    def begin_anew() -> None:
        with desk.thread.condition:
            desk.thread.drain(ended)
            ended.finish()
            desk.begin("left")
            desk.send("left", 3, first=2)
        desk.meanwhile = lambda: None

    desk.meanwhile = begin_anew
    desk.thread.process_round()
    desk.thread.process_round()
    assert (ended.counter.received, desk.recorded("left")) == (1, 3)
