"""The state of the hand in the status of a running recording."""

import math

import pytest

from teachpath.records import HandState, Phase, RecordingStatus
from tests.unit.recorder.recorders import SCENE, Bench
from tests.unit.recording.hands import CLOSED_HAND, OPEN_HAND, demonstration, sample

SAMPLE_COUNT = 110
START = (0.5, 0.0, 0.48)


def shown(bench: Bench) -> RecordingStatus:
    (status,) = bench.recorder.shown_statuses()
    return status


def seen(bench: Bench) -> HandState:
    hand = shown(bench).hand
    assert hand is not None
    return hand


def test_there_is_no_hand_before_its_first_sample_and_none_without_a_recording(bench: Bench) -> None:
    bench.send(demonstration()[:1])
    assert bench.recorder.shown_statuses() == []
    bench.begin()
    assert shown(bench).hand is None


def test_the_object_is_in_the_hand_from_the_grasp_to_the_release(bench: Bench) -> None:
    bench.begin()
    stream, before = demonstration(), 0
    for upto, phase, closed in ((10, Phase.REACH, False), (21, Phase.GRASP, True), (60, Phase.TRANSPORT, True)):
        bench.send(stream[before:upto])
        before = upto
        bench.received(upto)
        status, hand = shown(bench), seen(bench)
        assert (status.phase, hand.is_closed, status.carried) == (phase, closed, SCENE.carried)
        if phase is Phase.REACH:
            assert hand.carried_pose is None
        else:
            assert hand.carried_pose is not None
            moved = hand.position[0] - 0.5
            assert hand.carried_pose[0] == pytest.approx((START[0] + moved, START[1], START[2]))
    bench.send(stream[60:])
    bench.received(SAMPLE_COUNT)
    after = seen(bench)
    assert (shown(bench).phase, after.carried_pose, after.take) == (Phase.REACH, None, hand.take + 1)


def test_the_object_turns_with_the_hand_about_the_place_where_it_is_held(bench: Bench) -> None:
    bench.begin()
    quarter = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
    bench.send([sample(1, (0.5, 0.05, 0.48), OPEN_HAND), sample(2, (0.5, 0.05, 0.48), CLOSED_HAND)])
    bench.send([sample(3, (0.6, 0.05, 0.48), CLOSED_HAND, orientation=quarter)])
    bench.received(3)
    carried = seen(bench).carried_pose
    assert carried is not None
    # It hung 5 cm behind the hand along y; a quarter turn about z brings it 5 cm ahead along x.
    assert carried[0] == pytest.approx((0.65, 0.05, 0.48))
    assert carried[1] == pytest.approx(quarter)


def test_a_hand_that_is_not_tracked_is_not_drawn(bench: Bench) -> None:
    bench.begin()
    bench.send([sample(1, (0.5, 0.3, 0.5)), sample(2, (0.5, 0.3, 0.5), tracked=False)])
    bench.received(2)
    assert shown(bench).hand is None


def test_a_status_has_hand_and_statistics_only_where_they_are_asked_for(bench: Bench) -> None:
    bench.begin()
    bench.send(demonstration()[:30])
    bench.received(30)
    (plain,) = bench.recorder.statuses()
    (full,) = bench.recorder.statuses(with_statistics=True)
    assert (plain.hand, plain.statistics, shown(bench).statistics) == (None, None, None)
    assert full.statistics is not None
    assert full.statistics.received == 30
