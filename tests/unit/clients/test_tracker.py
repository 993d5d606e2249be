from itertools import pairwise
from typing import Any

import pytest

from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading
from teachpath_client.tracker import Routine, Tracker
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys

KEYS = Keys("lab")


class MemoryLink:
    """A link that keeps what is sent, and a clock that only moves when the tracker waits."""

    def __init__(self) -> None:
        self.now = 100.0
        self.sent: list[tuple[float, tracker_pb2.HandSample]] = []
        self.asked: list[tuple[str, bytes]] = []
        self.alive: list[str] = []
        self.heard: list[tuple[str, Any]] = []
        self.key = ""

    def publisher(self, key: str) -> Any:
        self.key = key
        return self

    def put(self, payload: bytes) -> None:
        self.sent.append((self.now, tracker_pb2.HandSample.FromString(payload)))

    def announce(self, key: str) -> object:
        self.alive.append(key)
        return object()

    def subscribe(self, key: str, receive: Any) -> None:
        self.heard.append((key, receive))

    def ask(self, key: str, payload: bytes) -> bytes:
        self.asked.append((key, payload))
        return tracker_pb2.RecordingReport(tracker="glove", received=len(self.sent)).SerializeToString()

    def sleep(self, seconds: float) -> None:
        assert seconds > 0
        self.now += seconds


@pytest.fixture
def link() -> MemoryLink:
    return MemoryLink()


@pytest.fixture
def tracker(link: MemoryLink) -> Tracker:
    return Tracker(link, "glove", prefix="lab", clock=lambda: link.now, sleep=link.sleep)  # type: ignore[arg-type]


def readings(count: int) -> list[HandReading]:
    return [HandReading(i * 0.02, (0.01 * i, 0.0, 0.5)) for i in range(count)]


@pytest.mark.parametrize("speed", [0.5, 1.0, 4.0])
def test_readings_go_out_when_they_are_due(tracker: Tracker, link: MemoryLink, speed: float) -> None:
    assert tracker.publish(readings(50), speed=speed) == 50
    assert [at - 100.0 for at, _ in link.sent] == pytest.approx([i * 0.02 / speed for i in range(50)])


def test_the_device_clock_keeps_its_own_pace(tracker: Tracker, link: MemoryLink) -> None:
    tracker.publish(readings(50), speed=4.0)
    stamps = [message.device_ns for _, message in link.sent]
    assert {b - a for a, b in pairwise(stamps)} == {20_000_000}


def test_a_late_tracker_catches_up_and_leaves_nothing_out(tracker: Tracker, link: MemoryLink) -> None:
    def slow() -> Any:
        for i, reading in enumerate(readings(10)):
            if i == 3:
                link.now += 0.1
            yield reading

    tracker.publish(slow())
    assert [message.sequence for _, message in link.sent] == list(range(1, 11))
    assert link.sent[-1][0] == pytest.approx(100.0 + 9 * 0.02)


def test_the_clock_of_a_stream_begins_with_its_first_reading(tracker: Tracker, link: MemoryLink) -> None:
    def late() -> Any:
        link.now += 30.0
        yield from readings(10)

    tracker.publish(late())
    assert [at - 130.0 for at, _ in link.sent] == pytest.approx([i * 0.02 for i in range(10)])


def test_sequence_numbers_go_on_and_stop_names_the_last(tracker: Tracker, link: MemoryLink) -> None:
    tracker.start("lift", scene="paper", calibration="lab")
    tracker.publish(readings(3))
    tracker.publish(readings(2))
    report = tracker.stop(discard=True)
    assert [message.sequence for _, message in link.sent] == [1, 2, 3, 4, 5]
    assert report.received == 5
    (start_key, start), (stop_key, stop) = link.asked
    assert (start_key, stop_key) == (KEYS.recorder_start, KEYS.recorder_stop)
    begun = tracker_pb2.StartRecording.FromString(start)
    assert (begun.task, begun.tracker, begun.scene, begun.calibration) == ("lift", "glove", "paper", "lab")
    ended = tracker_pb2.StopRecording.FromString(stop)
    assert (ended.tracker, ended.last_sequence, ended.discard) == ("glove", 5, True)


@pytest.mark.parametrize("countdown", [None, 0.0, 3.0])
def test_a_routine_is_told_and_a_countdown_that_is_not_said_is_not_sent(
    tracker: Tracker, link: MemoryLink, countdown: float | None
) -> None:
    tracker.start("lift", rate=50.0, routine=Routine(armed=True, countdown=countdown, takes=5, one_by_one=True))
    begun = tracker_pb2.StartRecording.FromString(link.asked[-1][1])
    assert (begun.rate, begun.armed, begun.takes, begun.one_by_one) == (50.0, True, 5, True)
    assert (begun.countdown if begun.HasField("countdown") else None) == countdown


def test_a_tracker_hears_the_feedback_to_its_name(tracker: Tracker, link: MemoryLink) -> None:
    tracker.subscribe_feedback(print)
    assert link.heard == [(KEYS.feedback("glove"), print)]


def test_a_tracker_shows_that_it_is_alive_and_publishes_under_its_name(tracker: Tracker, link: MemoryLink) -> None:
    assert link.alive == [KEYS.alive("tracker", tracker.name)]
    assert link.key == KEYS.samples(tracker.name)


@pytest.mark.parametrize("name", ["", "a/b", "*", "a..b", "-a"])
def test_a_name_that_cannot_be_one_is_refused_before_anything_is_sent(name: str, link: MemoryLink) -> None:
    with pytest.raises(ClientError, match="cannot name a tracker"):
        Tracker(link, name)  # type: ignore[arg-type]
    assert not link.alive


def test_a_reading_says_only_what_was_measured() -> None:
    bare = HandReading(0.5, (1.0, 2.0, 3.0)).message(7, 1_000)
    assert (bare.sequence, bare.device_ns, list(bare.flexions)) == (7, 500_001_000, [])
    assert (bare.orientation.w, bare.orientation.x) == (0.0, 0.0)
    full = HandReading(0.0, (0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.5,) * 18, False, 1).message(1, 0)
    assert (full.orientation.x, len(full.flexions), full.tracked, full.buttons) == (1.0, 18, False, 1)
