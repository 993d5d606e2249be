import numpy as np
import pytest

from teachpath.recording.phases import Segmenter, TransportSpan
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Phase, Sample
from teachpath_proto.sample_rules import GRASP_BUTTON
from tests.unit.recording.hands import CLOSED_HAND, OPEN_HAND, demonstration, sample

OBJECT = (0.5, 0.0, 0.5)


def cuts_of(samples: list[Sample], carried: tuple[float, float, float] | None = OBJECT) -> list[TransportSpan]:
    segmenter = Segmenter(RecordingSettings(), carried)
    cuts = [segmenter.push(s, np.array(s.position)) for s in samples]
    return [cut for cut in [*cuts, segmenter.finish()] if cut is not None]


def test_cuts_reach_transport_and_return() -> None:
    (cut,) = cuts_of(demonstration())
    assert (cut.grasp, cut.release, cut.open_ended) == (20, 70, False)


def test_cuts_one_stream_into_as_many_demonstrations_as_were_shown() -> None:
    one = demonstration()
    stream = [s for i in range(5) for s in demonstration(1 + i * len(one))]
    assert len(cuts_of(stream)) == 5


def test_a_hand_that_closes_away_from_the_object_grasps_nothing() -> None:
    assert cuts_of(demonstration(at=(0.5, 0.2, 0.5))) == []
    assert len(cuts_of(demonstration(at=(0.5, 0.2, 0.5)), carried=None)) == 1


def test_noise_between_the_thresholds_changes_nothing() -> None:
    random = np.random.default_rng(3)
    steady = demonstration()
    noise = random.normal(0, 0.09, (len(steady), 22))
    noisy = [s._replace(flexions=tuple(np.clip(s.flexions + n, 0, 1))) for s, n in zip(steady, noise, strict=True)]
    assert [(c.grasp, c.release) for c in cuts_of(noisy)] == [(c.grasp, c.release) for c in cuts_of(steady)]


def test_a_button_grasps_like_a_glove() -> None:
    held = [s._replace(flexions=(), buttons=GRASP_BUTTON if s.flexions == CLOSED_HAND else 0) for s in demonstration()]
    assert [(c.grasp, c.release) for c in cuts_of(held)] == [(20, 70)]


def test_the_end_of_the_stream_completes_what_was_released_and_marks_what_was_not() -> None:
    stream = demonstration()
    (released,) = cuts_of(stream[:75])
    (holding,) = cuts_of(stream[:60])
    assert not released.open_ended
    assert holding.open_ended
    assert cuts_of(stream[:15]) == []


def test_a_hand_that_never_rests_still_ends_its_demonstration() -> None:
    stream = demonstration()[:75]
    moving = [sample(stream[-1].sequence + i, (0.02 * i, 0.0, 0.5), OPEN_HAND) for i in range(1, 400)]
    segmenter = Segmenter(RecordingSettings(longest_return=3.0), OBJECT)
    ended = [i for i, s in enumerate(stream + moving) if segmenter.push(s, np.array(s.position))]
    assert ended == [pytest.approx(70 + 3.0 * 50, abs=2)]


def test_phases_come_in_their_order() -> None:
    segmenter = Segmenter(RecordingSettings(), OBJECT)
    seen: list[Phase] = []
    for s in demonstration()[:80]:
        segmenter.push(s, np.array(s.position))
        if not seen or seen[-1] is not segmenter.phase:
            seen.append(segmenter.phase)
    assert seen == list(Phase)


# gloves as they are


def closing(closures: list[float], positions: list[tuple[float, float, float]], noise: float = 0.0) -> list[Sample]:
    random = np.random.default_rng(5)
    flexions = np.clip(np.array(closures)[:, None] + random.normal(0.0, noise, (len(closures), 22)), 0.0, 1.0)
    return [sample(i, p, tuple(map(float, f))) for i, (p, f) in enumerate(zip(positions, flexions, strict=True), 1)]


def carry(steps: int) -> list[tuple[float, float, float]]:
    return [(0.5 + 0.01 * i, 0.0, 0.5) for i in range(steps)]


@pytest.mark.parametrize("noise", [0.05, 0.15, 0.3])
def test_a_slow_noisy_closing_and_opening_is_one_grasp(noise: float) -> None:
    ramp = list(np.linspace(0.1, 0.9, 40))
    closures = ramp + [0.9] * 60 + ramp[::-1] + [0.1] * 40
    positions = [OBJECT] * 40 + carry(60) + [carry(60)[-1]] * 80
    (cut,) = cuts_of(closing(closures, positions, noise))
    assert 20 <= cut.grasp <= 30
    assert 110 <= cut.release <= 130


def test_a_double_grasp_before_the_object_moves_is_one_demonstration_from_the_second() -> None:
    closures = [0.1] * 10 + [0.9] * 10 + [0.1] * 10 + [0.9] * 60 + [0.1] * 40
    positions = [OBJECT] * 30 + carry(60) + [carry(60)[-1]] * 40
    (cut,) = cuts_of(closing(closures, positions))
    assert (cut.grasp, cut.release) == (30, 90)


def test_fingers_that_flicker_while_they_carry_have_not_let_go() -> None:
    closures = [0.1] * 10 + [0.9] * 60 + [0.1] * 40
    for i in (30, 31, 32, 50):
        closures[i] = 0.1
    (cut,) = cuts_of(closing(closures, [OBJECT] * 10 + carry(60) + [carry(60)[-1]] * 40))
    assert (cut.grasp, cut.release) == (10, 70)


def test_an_object_that_is_dropped_ends_its_demonstration_and_is_not_picked_up_from_the_floor() -> None:
    closures = [0.1] * 10 + [0.9] * 40 + [0.1] * 10 + [0.9] * 40 + [0.1] * 40
    positions = [OBJECT] * 10 + carry(40) + [(0.9, 0.0, 0.5)] * 90
    (cut,) = cuts_of(closing(closures, positions))
    assert (cut.grasp, cut.release) == (10, 50)


def test_a_grasp_of_the_object_that_is_back_in_its_place_begins_the_next_one() -> None:
    closures = [0.1] * 10 + [0.9] * 40 + [0.1] * 10 + [0.9] * 40 + [0.1] * 40
    back = [(0.9 - 0.04 * i, 0.0, 0.5) for i in range(10)]
    positions = [OBJECT] * 10 + carry(40) + back + carry(40) + [carry(40)[-1]] * 40
    first, second = cuts_of(closing(closures, positions))
    assert (first.grasp, first.release) == (10, 50)
    assert (second.grasp, second.release) == (0, 40)


def test_a_hand_that_closes_and_opens_at_the_object_has_carried_nothing() -> None:
    closures = [0.1] * 10 + [0.9] * 60 + [0.1] * 60
    assert cuts_of(closing(closures, [OBJECT] * 130, noise=0.1)) == []


@pytest.mark.parametrize(
    ("away", "flexion", "said"),
    [
        (0.18, 0.9, "closed 18 cm from the object, limit 8 cm: close it there"),
        (1.7, 0.9, "closed 170 cm from the object, limit 8 cm: close it there; if it was there, measure"),
        (0.0, 0.5, "reads 0.50 at the object and counts as closed over 0.6: close the hand further"),
        (0.3, 0.5, ""),
        (0.0, 0.9, ""),
        (0.3, 0.1, ""),
    ],
)
def test_a_hand_that_grasps_nothing_is_told_why_within_a_second(away: float, flexion: float, said: str) -> None:
    x, y, z = (0.5, 0.0, 0.5)
    segmenter = Segmenter(RecordingSettings(), (x, y, z))
    for n in range(50):
        flexions = (flexion if n >= 5 else 0.1,) * 22
        segmenter.push(sample(n, (x, y + away, z), flexions), (x, y + away, z))
    assert said in segmenter.hint, segmenter.hint
    assert bool(segmenter.hint) == bool(said)
