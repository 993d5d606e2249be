"""Learning is pure: no state of the process, no clock, no chance that is not seeded; and all of it can be pickled."""

from __future__ import annotations

import ast
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from teachpath.errors import LearningFailed
from teachpath.io.documents import encode
from teachpath.learning.clustering.cuts import dendrogram
from teachpath.learning.clustering.subsampled_clustering import cluster_paths
from teachpath.learning.fitting.nurbs_fit import CurveDistance, approximate
from teachpath.learning.learn import learn
from teachpath.learning.resampling import at_equal_arc_length
from teachpath.learning.selection.consistency import measure
from teachpath.learning.selection.features import extract_features, positions_and_velocities
from teachpath.learning.selection.gaussian_hmm import TrainingBudget, train_model
from teachpath.learning.settings import LearningSettings, StepCounter, Subprogress, no_progress
from teachpath.records import Learned, Trajectory
from tests.unit.learning import synthetic

LEARNING_FOLDER = Path(__file__).parents[3] / "service" / "teachpath" / "learning"
FILES = sorted(LEARNING_FOLDER.rglob("*.py"))
CHANGING_NAMES = {
    "cache",
    "lru_cache",
    "cached_property",
    "uuid",
    "uuid4",
    "secrets",
    "random",
    "datetime",
    "perf_counter",
}


def shown() -> dict[str, Trajectory]:
    return synthetic.experiment_2(1)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.relative_to(LEARNING_FOLDER).as_posix())
def test_no_module_keeps_state_or_asks_clock_or_chance(file: Path) -> None:
    tree = ast.parse(file.read_text())
    for node in ast.walk(tree):
        assert not isinstance(node, ast.Global), ast.unparse(node)
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = {alias.name.split(".")[0] for alias in node.names} | {getattr(node, "module", "") or ""}
            assert not names & CHANGING_NAMES, ast.unparse(node)
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("default_rng"):
            assert node.args, "a generator without a seed"
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "np.random":
            assert node.attr in ("Generator", "default_rng"), "numpy's own generator belongs to the whole process"


def test_what_learning_makes_can_be_pickled() -> None:
    demonstrations = shown()
    learned = learn(demonstrations, LearningSettings(repeats=0))
    again: Learned = pickle.loads(pickle.dumps(learned))
    assert encode(again) == encode(learned)
    trajectories = list(demonstrations.values())
    paths = np.stack([at_equal_arc_length(each.positions, 50) for each in trajectories])
    features = [extract_features(trajectory) for trajectory in trajectories]
    measures = measure(features, paths, 0.7, 0.005)
    made: list[Any] = [
        LearningSettings(),
        cluster_paths(paths, LearningSettings(), length=1.0, metric="arc"),
        dendrogram(learned, 3),
        features[0],
        measures,
        approximate(paths[0], 0.01, degree=3, most=20),
    ]
    for one in made:
        assert type(pickle.loads(pickle.dumps(one))) is type(one)
    np.testing.assert_equal(pickle.loads(pickle.dumps(measures)).scores(range(5)), measures.scores(range(5)))
    measured = CurveDistance(learned.paths[0].curve)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(measured))(paths[0]), measured(paths[0]))
    sequences = positions_and_velocities(trajectories)
    model = train_model(sequences, 5, TrainingBudget())
    copied = pickle.loads(pickle.dumps(model))
    np.testing.assert_array_equal(copied.log_likelihoods(sequences[0]), model.log_likelihoods(sequences[0]))


def test_progress_and_errors_can_be_pickled() -> None:
    for progress in (Subprogress(no_progress, 0.2, 0.4), StepCounter(no_progress, 3, "counting")):
        assert pickle.loads(pickle.dumps(progress)) == progress
    error = pickle.loads(pickle.dumps(LearningFailed("take-7 stands still", "take-7")))
    assert (str(error), error.demonstration) == ("take-7 stands still", "take-7")


def test_learning_twice_gives_the_same_and_leaves_its_input_as_it_was() -> None:
    demonstrations = shown()
    before = pickle.dumps(demonstrations)
    first = encode(learn(demonstrations, LearningSettings(mode="paper", threshold=0.08)))
    assert encode(learn(demonstrations, LearningSettings(mode="paper", threshold=0.08))) == first
    assert pickle.dumps(demonstrations) == before
