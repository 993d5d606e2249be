"""What operators and trackers can do to a recording: pause, pedal, come, go, fall silent, count anew."""

import pytest

from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.recording.phases import TOGGLE_BUTTON
from teachpath.records import Sample, StopRequest
from teachpath_proto import tracker_pb2
from teachpath_proto.sample_rules import GRASP_BUTTON
from tests.unit.recorder.recorders import KEYS, Bench
from tests.unit.recording.hands import CLOSED_HAND, PERIOD_NS, START_NS, demonstration, sample

SAMPLE_COUNT = 110  # samples of a demonstration


def verdicts(bench: Bench) -> list[tuple[str, tuple[str, ...]]]:
    return [(d.verdict, d.reasons) for d in bench.store.demonstrations("lift")]


def query(bench: Bench, key: str, tracker: str = "glove") -> tracker_pb2.RecordingReport:
    answer = bench.bus.ask(key, tracker_pb2.PauseRecording(tracker=tracker).SerializeToString())
    return tracker_pb2.RecordingReport.FromString(answer)


# pause and resume


def test_what_is_shown_while_paused_is_no_demonstration_and_no_loss(bench: Bench) -> None:
    bench.begin()
    shown = [demonstration(1 + i * SAMPLE_COUNT) for i in range(3)]
    bench.send(shown[0])
    bench.received(SAMPLE_COUNT)
    assert query(bench, KEYS.recorder_pause).state == "paused"
    bench.send(shown[1])
    bench.received(2 * SAMPLE_COUNT)
    assert query(bench, KEYS.recorder_resume).state == "recording"
    bench.send(shown[2])
    report = bench.end(3 * SAMPLE_COUNT)
    assert (report.received, report.lost, len(report.demonstrations)) == (3 * SAMPLE_COUNT, 0, 2)
    first, second = bench.store.demonstrations("lift")
    assert (first.verdict, second.verdict) == ("clean", "clean")
    assert first.samples + second.samples + report.idle == report.received
    assert [d.statistics.received for d in (first, second)] == [first.samples, second.samples]
    assert bench.store.recordings.samples(second.recording)[0].sequence > 2 * SAMPLE_COUNT


def test_a_pause_while_something_is_carried_waits_for_the_end_of_the_take(bench: Bench) -> None:
    bench.begin()
    shown = demonstration()
    bench.send(shown[:40])
    bench.received(40)
    assert query(bench, KEYS.recorder_pause).state == "pausing"
    assert query(bench, KEYS.recorder_pause).state == "pausing"
    bench.send(shown[40:])
    assert bench.until(lambda report: report.state == "paused").demonstrations
    assert verdicts(bench) == [("clean", ())]
    assert bench.end(SAMPLE_COUNT).received == SAMPLE_COUNT


def test_an_armed_recording_waits_for_the_pedal_and_the_pedal_pauses_again(bench: Bench) -> None:
    def pressed(samples: list[Sample]) -> list[Sample]:
        return [s._replace(buttons=TOGGLE_BUTTON) if i < 3 else s for i, s in enumerate(samples)]

    bench.begin(armed=True)
    bench.send(demonstration())
    assert bench.received(SAMPLE_COUNT).state == "paused"
    bench.send(pressed(demonstration(SAMPLE_COUNT + 1)))
    assert len(bench.received(2 * SAMPLE_COUNT).demonstrations) == 1
    bench.send(pressed(demonstration(2 * SAMPLE_COUNT + 1)))
    report = bench.received(3 * SAMPLE_COUNT)
    assert (report.state, report.pedal_used, len(report.demonstrations)) == ("paused", True, 1)


# trackers that come and go


def test_trackers_are_there_by_their_token_or_by_what_they_send(bench: Bench) -> None:
    token = bench.bus.announce(KEYS.alive("tracker", "glove"))
    bench.send(demonstration()[:1], "plain")
    bench.begin()
    bench.send(demonstration()[:1])
    bench.received(1)
    assert [(t.name, t.announced, t.silence) for t in bench.recorder.trackers()] == [
        ("glove", True, 0.0),
        ("plain", False, 0.0),
    ]
    bench.now = 3.0
    assert [t.name for t in bench.recorder.trackers()] == ["glove"]
    token.close()
    bench.until(lambda report: report.state == "lost")
    assert bench.recorder.trackers() == []


def test_a_tracker_lost_while_it_carries_leaves_a_reject_that_says_so(bench: Bench) -> None:
    token = bench.bus.announce(KEYS.alive("tracker", "glove"))
    bench.begin()
    bench.send(demonstration()[:50])
    token.close()
    report = bench.until(lambda report: report.state == "lost")
    assert verdicts(bench) == [("reject", ("the tracker has gone in mid-take",))]
    assert "the tracker has gone in mid-take" in report.notes
    assert bench.store.recordings.unfinished() == []


def test_a_tracker_lost_after_the_release_leaves_a_repaired_one(bench: Bench) -> None:
    token = bench.bus.announce(KEYS.alive("tracker", "glove"))
    bench.begin()
    bench.send(demonstration()[:75])
    token.close()
    bench.until(lambda report: report.state == "lost")
    assert verdicts(bench) == [("repaired", ("the tracker has gone in mid-take",))]


def test_a_tracker_that_comes_back_with_a_closed_hand_has_grasped_nothing(bench: Bench) -> None:
    token = bench.bus.announce(KEYS.alive("tracker", "glove"))
    bench.begin()
    shown = demonstration()
    bench.send(shown[:22])
    token.close()
    bench.until(lambda report: report.state == "lost")
    bench.send(shown[22:])
    bench.send(demonstration(SAMPLE_COUNT + 1))
    report = bench.end(2 * SAMPLE_COUNT)
    assert (report.lost, len(report.demonstrations)) == (0, 1)


def test_a_client_that_died_may_start_again_at_once_and_counts_anew(bench: Bench) -> None:
    token = bench.bus.announce(KEYS.alive("tracker", "glove"))
    bench.begin()
    bench.send(demonstration()[:50])
    token.close()
    bench.until(lambda report: report.state == "lost")
    bench.bus.announce(KEYS.alive("tracker", "glove"))
    bench.begin()
    bench.send(demonstration())
    report = bench.end(SAMPLE_COUNT)
    assert (report.received, report.duplicated, len(report.demonstrations)) == (SAMPLE_COUNT, 0, 1)
    assert [verdict for verdict, _ in verdicts(bench)] == ["reject", "clean"]


def test_a_client_that_comes_back_within_its_recording_counts_anew(bench: Bench) -> None:
    token = bench.bus.announce(KEYS.alive("tracker", "glove"))
    bench.begin()
    bench.send(demonstration()[:15])
    token.close()
    bench.until(lambda report: report.state == "lost")
    bench.send([s._replace(device_ns=s.device_ns + 10**10) for s in demonstration()])
    report = bench.end(SAMPLE_COUNT)
    assert (report.received, report.duplicated, len(report.demonstrations)) == (SAMPLE_COUNT + 15, 0, 1)
    assert verdicts(bench) == [("clean", ())]
    with pytest.raises(NotFound):
        bench.recorder.end(StopRequest("glove"))


def test_a_tracker_that_falls_silent_in_mid_take_ends_it(bench: Bench) -> None:
    bench.begin()
    bench.send(demonstration()[:50])
    bench.received(50)
    bench.now = 1.9
    bench.send(demonstration()[:1], "other")  # lets the recorder look at its clock
    assert bench.until(lambda report: True).phase == "transport"
    bench.now = 2.5
    report = bench.until(lambda report: report.state == "lost")
    assert verdicts(bench) == [("reject", ("no sample came for 2 s in mid-take",))]
    assert report.phase == "reach"
    bench.send(demonstration(51))
    assert bench.until(lambda report: len(report.demonstrations) == 2).state == "recording"


def test_a_tracker_that_waits_between_takes_is_not_lost(bench: Bench) -> None:
    bench.begin()
    bench.send(demonstration())
    bench.received(SAMPLE_COUNT)
    bench.now = 60.0
    bench.send(demonstration()[:1], "other")
    bench.send(demonstration(SAMPLE_COUNT + 1))
    assert len(bench.end(2 * SAMPLE_COUNT).demonstrations) == 2


# hostile streams


def test_two_trackers_of_one_name_make_no_demonstration_that_is_trusted(bench: Bench) -> None:
    bench.begin()
    for one, other in zip(demonstration(), demonstration(at=(0.6, 0.2, 0.7)), strict=True):
        bench.send([one, other._replace(device_ns=other.device_ns + 3_000_000)])
    bench.end(SAMPLE_COUNT)
    assert [verdict for verdict, _ in verdicts(bench)] == ["reject"]
    assert any("two trackers" in note for note in bench.store.demonstrations("lift")[0].statistics.notes)


@pytest.mark.parametrize("away_ns", [10**18, -(10**18), 3600 * 10**9, -3600 * 10**9])
def test_samples_of_the_past_and_the_future_are_taken_with_their_offset(bench: Bench, away_ns: int) -> None:
    bench.begin()
    shown = [s._replace(device_ns=s.device_ns + away_ns) for s in demonstration()]
    bench.send(shown)
    bench.end(SAMPLE_COUNT)
    (row,) = bench.store.demonstrations("lift")
    assert row.verdict == "clean"
    assert row.duration == pytest.approx(49 * 0.02)


def test_a_clock_that_jumps_in_mid_take_rejects_it(bench: Bench) -> None:
    bench.begin()
    bench.send([s._replace(device_ns=s.device_ns - 5 * 10**9 * (i >= 40)) for i, s in enumerate(demonstration())])
    assert bench.end(SAMPLE_COUNT).clock_jumps == 1
    assert verdicts(bench) == [("reject", ("the device's clock jumps once",))]


def test_positions_that_jump_are_left_out_of_what_is_learned(bench: Bench) -> None:
    bench.begin()
    shown = demonstration(transport=60)
    shown[45] = shown[45]._replace(position=(0.0, 0.9, 0.9))
    bench.send(shown)
    bench.end(SAMPLE_COUNT + 10)
    (row,) = bench.store.demonstrations("lift")
    assert (row.verdict, row.reasons, row.left_out) == ("repaired", ("1 sample jumping",), (46,))
    (_, trajectory) = bench.recorded[0]
    assert len(trajectory) == 59
    assert abs(trajectory.positions[:, 1]).max() < 0.01
    assert (bench.recorder.annotations.trajectory(row).positions == trajectory.positions).all()
    assert len(bench.store.recordings.samples(row.recording)) == row.samples


def test_the_declared_rate_is_held_against_the_seen_one(bench: Bench) -> None:
    bench.begin(rate=60.0)
    bench.send(demonstration())
    report = bench.end(SAMPLE_COUNT)
    assert (report.declared_rate, report.seen_rate) == (60.0, pytest.approx(50.0))
    assert verdicts(bench) == [("repaired", ("the rate is 50 Hz, declared 60 Hz",))]
    for rate in (-1.0, float("nan"), 1e9):
        with pytest.raises(UnusableInput, match=r"rate (of|should be finite)"):
            bench.begin(rate=rate)


def test_a_flood_of_names_is_not_remembered(bench: Bench) -> None:
    bench.begin()
    for i in range(3000):
        bench.bus.publish(KEYS.samples(f"flood-{i}"), b"")
    bench.send(demonstration())
    bench.received(SAMPLE_COUNT)
    assert len(bench.recorder.trackers()) <= 1000


def test_a_button_device_lost_in_mid_take_is_a_reject(bench: Bench) -> None:
    token = bench.bus.announce(KEYS.alive("tracker", "glove"))
    bench.begin()
    held = [s._replace(flexions=(), buttons=GRASP_BUTTON * (s.flexions == CLOSED_HAND)) for s in demonstration()]
    bench.send(held[:60])
    token.close()
    bench.until(lambda report: report.state == "lost")
    assert [verdict for verdict, _ in verdicts(bench)] == ["reject"]


def test_a_running_recording_is_not_taken_over(bench: Bench) -> None:
    bench.begin()
    bench.send([sample(1, (0.0, 0.0, 0.0), device_ns=START_NS + PERIOD_NS)])
    bench.received(1)
    with pytest.raises(Conflict, match="already recording lift"):
        bench.begin()
