from dataclasses import replace

import numpy as np
import pytest

from teachpath.recording import GRASP_BUTTON, Cut, RecordingSettings, Segmenter
from teachpath.records import Phase, Sample
from tests.unit.recording.hands import CLOSED, OPEN, demonstration, sample

OBJECT = (0.5, 0.0, 0.5)


def cuts_of(samples: list[Sample], carried: tuple[float, float, float] | None = OBJECT) -> list[Cut]:
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
    noisy = [replace(s, flexions=tuple(np.clip(s.flexions + n, 0, 1))) for s, n in zip(steady, noise, strict=True)]
    assert [(c.grasp, c.release) for c in cuts_of(noisy)] == [(c.grasp, c.release) for c in cuts_of(steady)]


def test_a_button_grasps_like_a_glove() -> None:
    held = [replace(s, flexions=(), buttons=GRASP_BUTTON if s.flexions == CLOSED else 0) for s in demonstration()]
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
    moving = [sample(stream[-1].sequence + i, (0.02 * i, 0.0, 0.5), OPEN) for i in range(1, 400)]
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
    assert seen == [Phase.REACH, Phase.TRANSPORT, Phase.RETURN]
