"""Why two runs differ: causes first, and nothing when they are the same."""

from __future__ import annotations

from dataclasses import replace

import pytest

from teachpath.learning.compare import compare
from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath.records import Learned, Trajectory

SETTINGS = LearningSettings(repeats=0)


@pytest.fixture(scope="module")
def run(twelve: dict[str, Trajectory]) -> Learned:
    return learn(twelve, SETTINGS)


def test_the_same_inputs_and_settings_differ_in_nothing(run: Learned, twelve: dict[str, Trajectory]) -> None:
    assert compare(run, learn(twelve, SETTINGS)) == ()


def test_a_new_and_a_missing_demonstration_are_named(run: Learned, twelve: dict[str, Trajectory]) -> None:
    fewer = learn({k: d for k, d in twelve.items() if k != "7"}, SETTINGS)
    there, back = compare(run, fewer), compare(fewer, run)
    assert there[0] == "demonstration 7 is no longer learned from"
    assert back[0] == "demonstration 7 is new"
    assert any("cluster 3: the path moved by up to" in sentence for sentence in there)
    assert not any("cluster 1" in sentence or "cluster 2" in sentence for sentence in there)


def test_changed_samples_are_found_by_their_fingerprint(run: Learned, twelve: dict[str, Trajectory]) -> None:
    nudged = Trajectory(twelve["2"].times, twelve["2"].positions + 1e-4)
    sentences = compare(run, learn({**twelve, "2": nudged}, SETTINGS))
    assert sentences[0].startswith("demonstration 2 is changed")


def test_changed_settings_are_shown_with_both_values(run: Learned, twelve: dict[str, Trajectory]) -> None:
    sentences = compare(run, learn(twelve, replace(SETTINGS, error_bound=0.001)))
    assert sentences[0] == "setting error_bound: 0.005 became 0.001"
    assert any("degree and control points" in sentence for sentence in sentences)


def test_merged_ways_are_told(run: Learned, twelve: dict[str, Trajectory]) -> None:
    sentences = compare(run, learn(twelve, replace(SETTINGS, clusters=2)))
    assert any(sentence.startswith("3 clusters became 2") for sentence in sentences)
    assert any("is gone" in sentence for sentence in sentences)


def test_selections_are_compared(run: Learned, twelve: dict[str, Trajectory]) -> None:
    sentences = compare(run, learn(twelve, replace(SETTINGS, outlier_limit=1e-6)))
    assert any("no longer selected" in sentence for sentence in sentences)


def test_another_version_is_a_cause(run: Learned) -> None:
    other = replace(run, versions={**run.versions, "numpy": "1.0"})
    assert compare(other, run) == (f"version of numpy: 1.0 became {run.versions['numpy']}",)


def test_a_path_that_moved_without_a_cause_is_called_unexplained(run: Learned) -> None:
    curve = run.paths[0].curve
    moved = replace(run.paths[0], curve=replace(curve, control_points=curve.control_points + 0.01))
    sentences = compare(run, replace(run, paths=(moved, *run.paths[1:])))
    assert "cluster 1: the path moved by up to 1.7 cm" in sentences[0]
    assert sentences[-1].endswith("unexplained")


def test_a_run_without_fingerprints_says_that_it_cannot_tell(run: Learned) -> None:
    assert "cannot be told" in compare(replace(run, inputs={}), run)[0]
