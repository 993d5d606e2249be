"""Learning runs that several tests look at, made once."""

from __future__ import annotations

import pytest

from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath.records import Learned, Trajectory
from tests.unit.learning import synthetic


@pytest.fixture(scope="session")
def twelve() -> dict[str, Trajectory]:
    return synthetic.experiment_1(1)


@pytest.fixture(scope="session")
def learned(twelve: dict[str, Trajectory]) -> Learned:
    return learn(twelve, LearningSettings())


@pytest.fixture(scope="session")
def learned_as_paper(twelve: dict[str, Trajectory]) -> Learned:
    return learn(twelve, LearningSettings(mode="paper", threshold=0.08, repeats=0))
