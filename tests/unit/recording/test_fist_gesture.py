"""Signs of a fist, on flexions as noisy as a glove's."""

from collections.abc import Callable

import numpy as np
import pytest

from teachpath.recording.fist_gesture import FistGesture
from teachpath.recording.settings import RecordingSettings
from teachpath.records import FistCommand, Sample, Vector
from tests.unit.recording.hands import demonstration, sample

OBJECT = (0.5, 0.0, 0.5)
OTHER_PLACE = (0.2, 0.4, 0.5)
RATE = 50

Signs = list[FistCommand | None]


def signs(stream: list[Sample], *, carrying: bool = False) -> list[FistCommand]:
    gesture = FistGesture(RecordingSettings(), OBJECT)
    given = [gesture.push(s, s.position, carrying=carrying) for s in stream]
    return [sign for sign in given if sign is not None]


def fist(seconds: float, *, at: Callable[[int], Vector] = lambda i: OTHER_PLACE, noise: float = 0.0) -> list[Sample]:
    """Open for a second, a fist for `seconds`, open for a second."""
    random = np.random.default_rng(7)
    closures = [0.1] * RATE + [0.92] * round(seconds * RATE) + [0.1] * RATE
    flexions = np.clip(np.array(closures)[:, None] + random.normal(0.0, noise, (len(closures), 22)), 0.0, 1.0)
    return [sample(i, at(i), tuple(map(float, f))) for i, f in enumerate(flexions, 1)]


@pytest.mark.parametrize(
    ("seconds", "asked"),
    [
        (0.5, []),
        (1.2, [FistCommand.TOGGLE]),
        (2.8, [FistCommand.TOGGLE]),
        (3.2, [FistCommand.DISCARD]),
        (5.8, [FistCommand.DISCARD]),
        (7.0, []),
    ],
)
@pytest.mark.parametrize("noise", [0.0, 0.2])
def test_a_fist_says_what_it_was_held_for_and_nothing_when_it_rests(
    seconds: float, asked: list[FistCommand], noise: float
) -> None:
    assert signs(fist(seconds, noise=noise)) == asked


def test_fingers_that_flicker_are_one_fist() -> None:
    stream = fist(1.5)
    for i in (70, 71, 90):
        stream[i] = sample(stream[i].sequence, OTHER_PLACE, (0.1,) * 22)
    assert signs(stream) == [FistCommand.TOGGLE]


def test_two_fists_are_two_signs() -> None:
    first = fist(1.2)
    second = [sample(s.sequence + len(first), OTHER_PLACE, s.flexions) for s in fist(1.2)]
    assert signs(first + second) == [FistCommand.TOGGLE, FistCommand.TOGGLE]


def test_a_fist_at_the_object_or_while_it_is_carried_is_a_grasp() -> None:
    assert signs(fist(1.5, at=lambda i: OBJECT)) == []
    assert signs(fist(1.5), carrying=True) == []


def test_a_fist_that_moves_is_no_sign_until_it_has_opened() -> None:
    assert signs(fist(1.5, at=lambda i: (0.2, 0.4 + 0.002 * i, 0.5))) == []


def test_no_demonstration_looks_like_a_sign() -> None:
    stream = [s for i in range(5) for s in demonstration(1 + 110 * i)]
    assert signs(stream) == []


def test_without_a_glove_or_an_object_there_are_no_signs() -> None:
    stream = fist(1.5)
    nothing = FistGesture(RecordingSettings(), None)
    assert not any(nothing.push(s, s.position, carrying=False) for s in stream)
    off = FistGesture(RecordingSettings(fist_time=0.0), OBJECT)
    assert not any(off.push(s, s.position, carrying=False) for s in stream)
    bare = FistGesture(RecordingSettings(), OBJECT)
    assert not any(bare.push(sample(i, OTHER_PLACE, ()), OTHER_PLACE, carrying=False) for i in range(200))


def test_what_opening_would_ask_for_is_offered_while_the_fist_is_held() -> None:
    gesture = FistGesture(RecordingSettings(), OBJECT)
    pending_command: Signs = []
    for s in fist(7.0):
        gesture.push(s, OTHER_PLACE, carrying=False)
        if not pending_command or pending_command[-1] is not gesture.pending_command:
            pending_command.append(gesture.pending_command)
    assert pending_command == [None, FistCommand.TOGGLE, FistCommand.DISCARD, None]
