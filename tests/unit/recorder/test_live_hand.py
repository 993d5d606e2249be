"""The hand as the view sees it, from a running recording."""

import math

import pytest

from teachpath.recording.live_hand import Hand
from teachpath.records import Phase
from tests.unit.recorder.recorders import SCENE, Bench
from tests.unit.recording.hands import CLOSED, OPEN, demonstration, sample

SHOWN = 110
START = (0.5, 0.0, 0.48)


def seen(bench: Bench) -> Hand:
    (hand,) = bench.recorder.hands()
    return hand


def test_there_is_no_hand_before_its_first_sample_and_none_without_a_recording(bench: Bench) -> None:
    bench.send(demonstration()[:1])
    assert bench.recorder.hands() == []
    bench.begin()
    assert bench.recorder.hands() == []


def test_the_object_is_in_the_hand_from_the_grasp_to_the_release(bench: Bench) -> None:
    bench.begin()
    shown, before = demonstration(), 0
    for upto, phase, closed in ((10, Phase.REACH, False), (21, Phase.GRASP, True), (60, Phase.TRANSPORT, True)):
        bench.send(shown[before:upto])
        before = upto
        bench.received(upto)
        hand = seen(bench)
        assert (hand.phase, hand.closed, hand.thing) == (phase, closed, SCENE.carried)
        if phase is Phase.REACH:
            assert hand.carried is None
        else:
            assert hand.carried is not None
            moved = hand.position[0] - 0.5
            assert hand.carried[0] == pytest.approx((START[0] + moved, START[1], START[2]))
    bench.send(shown[60:])
    bench.received(SHOWN)
    after = seen(bench)
    assert (after.phase, after.carried, after.take) == (Phase.REACH, None, hand.take + 1)


def test_the_object_turns_with_the_hand_about_the_place_where_it_is_held(bench: Bench) -> None:
    bench.begin()
    quarter = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
    bench.send([sample(1, (0.5, 0.05, 0.48), OPEN), sample(2, (0.5, 0.05, 0.48), CLOSED)])
    bench.send([sample(3, (0.6, 0.05, 0.48), CLOSED, orientation=quarter)])
    bench.received(3)
    carried = seen(bench).carried
    assert carried is not None
    # It hung 5 cm behind the hand along y; a quarter turn about z brings it 5 cm ahead along x.
    assert carried[0] == pytest.approx((0.65, 0.05, 0.48))
    assert carried[1] == pytest.approx(quarter)


def test_a_hand_that_is_not_tracked_is_not_drawn(bench: Bench) -> None:
    bench.begin()
    bench.send([sample(1, (0.5, 0.3, 0.5)), sample(2, (0.5, 0.3, 0.5), tracked=False)])
    bench.received(2)
    assert bench.recorder.hands() == []
