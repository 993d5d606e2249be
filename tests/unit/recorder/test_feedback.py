"""Feedback to a hand: at once, once, and never on the recording thread."""

from teachpath.io.memory_bus import MemoryBus
from teachpath.recorder.feedback import REPEAT_INTERVAL, FeedbackPublisher
from teachpath.records import Phase, RecordingState, RecordingStatus
from teachpath_proto import tracker_pb2
from tests.contract.rows import demonstration as row
from tests.unit.recorder.recorders import KEYS, Bench
from tests.unit.recording.hands import demonstration


class Told:
    """A publisher on an in-memory bus whose polls the test makes, and all that it published."""

    def __init__(self) -> None:
        self.bus, self.now = MemoryBus(), 0.0
        self.statuses: list[RecordingStatus] = []
        self.heard: list[tracker_pb2.HandFeedback] = []
        self.bus.subscribe(
            KEYS.feedback("glove"), lambda _, p: self.heard.append(tracker_pb2.HandFeedback.FromString(p))
        )
        self.feedback = FeedbackPublisher(
            self.bus, KEYS, lambda: self.statuses, lambda key: row(key), clock=lambda: self.now
        )

    def look(self, *statuses: RecordingStatus) -> list[tracker_pb2.HandFeedback]:
        """Return what is published when the recordings have these statuses."""
        self.statuses, before = list(statuses), len(self.heard)
        self.feedback.publish_changes()
        return self.heard[before:]


def status(phase: str = "reach", state: str = "recording", **more: object) -> RecordingStatus:
    return RecordingStatus("lift", "glove", RecordingState(state), Phase(phase), **more)  # type: ignore[arg-type]


def test_a_change_is_told_once_and_all_again_each_second() -> None:
    told = Told()
    assert [f.holding for f in told.look(status())] == [False]
    assert told.look(status()) == []
    assert [(f.holding, f.phase) for f in told.look(status("grasp"))] == [(True, "grasp")]
    told.now += 0.5 * REPEAT_INTERVAL
    assert [f.holding for f in told.look(status("transport"))] == [True]
    told.now += 0.5 * REPEAT_INTERVAL
    assert told.look(status("transport")) == []
    told.now += 0.5 * REPEAT_INTERVAL
    assert [f.holding for f in told.look(status("transport"))] == [True]
    assert [f.holding for f in told.look(status("release"))] == [False]
    for _ in range(3):
        told.now += REPEAT_INTERVAL
        assert [(f.holding, f.phase) for f in told.look(status("release"))] == [(False, "release")]


def test_why_nothing_was_grasped_is_told_when_it_changes() -> None:
    told = Told()
    told.look(status())
    assert [f.hint for f in told.look(status(hint="the hand closed 18 cm from the object"))] == [
        "the hand closed 18 cm from the object"
    ]
    assert told.look(status(hint="the hand closed 18 cm from the object")) == []
    assert [f.hint for f in told.look(status("grasp"))] == [""]


def test_an_end_in_mid_take_lets_go() -> None:
    told = Told()
    told.look(status("transport"))
    assert [(f.holding, f.state) for f in told.look()] == [(False, "")]
    assert told.look() == []


def test_each_second_of_a_countdown_and_each_take_is_told() -> None:
    told = Told()
    told.look(status(state="countdown", countdown_left=3.0))
    said = [told.look(status(state="countdown", countdown_left=left)) for left in (2.6, 2.1, 2.0, 1.5, 0.9)]
    assert [len(each) for each in said] == [0, 0, 1, 0, 1]
    (made,) = told.look(status(demonstrations=("demo-1",), takes_left=4))
    assert (made.takes, made.takes_left, made.newest.demonstration, made.newest.verdict) == (1, 4, "demo-1", "clean")


def test_the_hand_hears_grasp_release_and_verdict_of_its_own_take(bench: Bench) -> None:
    heard: list[tracker_pb2.HandFeedback] = []
    bench.bus.subscribe(
        KEYS.feedback("glove"), lambda _, payload: heard.append(tracker_pb2.HandFeedback.FromString(payload))
    )
    samples = demonstration()
    bench.begin()
    for part in (samples[:15], samples[15:40], samples[40:80], samples[80:]):
        before = len(heard)
        bench.send(part)
        bench.until(lambda _, before=before: len(heard) > before)  # type: ignore[misc]
    assert [f.holding for f in heard][:1] == [False]
    assert True in [f.holding for f in heard]
    bench.until(lambda report: bool(heard[-1].newest.demonstration))
    assert (heard[-1].newest.verdict, heard[-1].holding) == ("clean", False)
    bench.end(samples[-1].sequence)
    bench.recorder.stop()
    assert heard[-1].state == ""
