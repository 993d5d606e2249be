"""Curves that somebody edits or adapts are computed in a process of their own, as they would be in this one."""

from collections.abc import Iterator

import numpy as np
import pytest

from teachpath.errors import UnusableInput
from teachpath.jobs.curve_assessor import CurveAssessor, Shown
from teachpath.learning.adaptation.adapt import adapt, course_model
from teachpath.learning.adaptation.target import Target
from teachpath.records import LearnedPath
from tests.unit.learning.adaptation.test_adapt import SETTINGS, U, path_of, several, to


@pytest.fixture(scope="module")
def assessor() -> Iterator[CurveAssessor]:
    assessor = CurveAssessor()
    assessor.warm_up()
    yield assessor
    assessor.stop()


@pytest.fixture(scope="module")
def case() -> tuple[LearnedPath, Shown]:
    shown = several(4)
    path = path_of(shown)
    return path, Shown(path.curve, shown, several(1, 2), SETTINGS)


def test_a_path_is_adapted_as_in_this_process(assessor: CurveAssessor, case: tuple[LearnedPath, Shown]) -> None:
    path, shown = case
    there = assessor.adapt(path, shown, to(path))
    here = adapt(path, shown.learned, shown.members, shown.others, to(path), SETTINGS)
    np.testing.assert_allclose(there.curve(U), here.curve(U), atol=1e-9)
    assert (there.note, there.is_base, here.is_base) == (here.note, False, False)
    assert assessor.adapt(path, shown, to(path, np.zeros(3))).is_base
    model, _, places = course_model(path, shown.learned, shown.members, shown.others, SETTINGS)
    exported = assessor.adaptation_model(path, shown)
    np.testing.assert_allclose(exported.version, model.version, atol=1e-9)
    assert exported.places == places


def test_a_refusal_comes_back_as_it_was_raised(assessor: CurveAssessor, case: tuple[LearnedPath, Shown]) -> None:
    path, shown = case
    turned = Target(path.curve(0.0), path.curve(1.0), np.array([1.0, 0, 0, 0]), np.array([1.0, 0, 0, 0]))
    with pytest.raises(UnusableInput):
        assessor.adapt(path, shown, turned)
    assert assessor.adapt(path, shown, to(path, np.zeros(3))).is_base
