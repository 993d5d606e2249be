"""What a run says about its clusters: the tube around a path, the fingerprint of an input."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from teachpath.io.documents import from_document, to_document
from teachpath.learning.fitting.nurbs_fit import approximate
from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath.learning.summary import fingerprint, representatives, tube_radius
from teachpath.records import Learned, Trajectory
from tests.unit.learning import synthetic

LINE = np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 200)


def test_the_tube_is_as_wide_as_the_demonstrations_are_apart() -> None:
    bow = 0.05 * np.sin(np.pi * LINE[:, 0])
    beside = LINE + np.outer(bow, [0.0, 1.0, 0.0])
    curve = approximate(LINE, 0.001, degree=3, most=60).curve
    radius = tube_radius(
        curve, [Trajectory(np.arange(200) * 0.02, path) for path in (LINE, beside)], on_step=lambda: None
    )
    np.testing.assert_allclose(radius, 0.05 * np.sin(np.pi * np.linspace(0, 1, 50)), atol=0.002)


def test_a_difference_along_the_path_does_not_widen_the_tube() -> None:
    curve = approximate(LINE, 0.001, degree=3, most=60).curve
    ahead = Trajectory(np.arange(200) * 0.02, LINE * np.array([1.1, 1, 1]))
    np.testing.assert_allclose(tube_radius(curve, [ahead], on_step=lambda: None), 0.0, atol=1e-6)


def test_the_representative_is_the_member_in_the_middle() -> None:
    offsets = np.array([0.3, 0.0, 0.1, 5.0, 5.2, 5.1, 9.0])
    courses = LINE + offsets[:, None, None]
    assert representatives(courses, np.array([1, 1, 1, 2, 2, 2, 3])).tolist() == [2, 5, 6]


def test_a_fingerprint_follows_every_sample_and_nothing_else() -> None:
    one = synthetic.experiment_2(1)["1"]
    same = Trajectory(one.times.copy(), np.asfortranarray(one.positions))
    nudged = one.positions.copy()
    nudged[77, 2] = np.nextafter(nudged[77, 2], 1)
    turned = synthetic.turning({"a": one})["a"]
    assert fingerprint(one) == fingerprint(same)
    assert len({fingerprint(each) for each in (one, replace(one, positions=nudged), turned)}) == 3


def test_a_run_survives_storing_and_one_stored_before_is_still_read(learned: Learned) -> None:
    document = to_document(learned)
    again = from_document(Learned, document)
    assert to_document(again) == document
    for cluster in document["clusters"]:
        for name in ("representative", "spread", "ambiguous"):
            del cluster[name]
        for score in cluster["scores"]:
            for name in ("margin", "z", "stability", "deviation"):
                del score[name]
    for path in document["paths"]:
        del path["orientation"], path["fit"]["frechet"], path["fit"]["turn"]
    del document["inputs"]
    old = from_document(Learned, document)
    assert old.clusters[0].spread is None
    assert old.clusters[0].members == learned.clusters[0].members


def test_copies_are_named_and_others_are_not() -> None:
    one, other = list(synthetic.experiment_2(1).values())[:2]
    learned = learn({"a": one, "b": other, "c": replace(one, times=one.times.copy()), "d": one}, LearningSettings())
    assert [note for note in learned.notes if "copies" in note] == [
        "demonstrations a, c and d are copies; their agreement says nothing"
    ]
    nudged = replace(one, positions=one.positions + 1e-9)
    assert not any("copies" in note for note in learn({"a": one, "b": nudged}, LearningSettings()).notes)
