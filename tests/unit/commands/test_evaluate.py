"""Learning held against known groups on the command line, without service or data folder; and two runs compared."""

import json
from contextlib import chdir
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sklearn.metrics import adjusted_rand_score
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.commands.evaluate import adjusted_rand_index, evaluation, read_groups
from teachpath.errors import NotFound, UnusableRecording, UnusableSettings
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath.records import Job, JobState, Learned, Trajectory
from tests.unit.learning import synthetic

QUICK_SETTINGS = LearningSettings(repeats=0)


@pytest.fixture(scope="module")
def three_ways() -> dict[str, list[Trajectory]]:
    rng = np.random.default_rng(2)
    return {
        name: [synthetic.demonstration(rng, way) for _ in range(3)]
        for name, way in zip("abc", synthetic.WAY_POINTS, strict=True)
    }


def write_csv(file: Path, trajectory: Trajectory) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    table = np.column_stack([trajectory.times, trajectory.positions])
    np.savetxt(file, table, delimiter=",", header="t,x,y,z", comments="")


def write_array(file: Path, trajectories: list[Trajectory]) -> None:
    still = np.tile([1.0, 0.0, 0.0, 0.0], (len(trajectories[0]), 1))
    np.save(file, np.stack([np.hstack([100 * t.positions, still]) for t in trajectories]))


def called(*arguments: object) -> str:
    runner = CliRunner(env={"TEACHPATH_LEARNING__REPEATS": "0"})
    result = runner.invoke(app, [str(argument) for argument in arguments], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.stdout


def test_sub_folders_are_groups_and_are_found_again(tmp_path: Path, three_ways: dict[str, list[Trajectory]]) -> None:
    for name, trajectories in three_ways.items():
        for i, trajectory in enumerate(trajectories):
            write_csv(tmp_path / "shown" / name / f"{i}.csv", trajectory)
    with chdir(tmp_path):
        report = json.loads(called("evaluate", tmp_path / "shown", "--json"))
    assert [file.name for file in tmp_path.iterdir()] == ["shown"]
    assert report["adjusted_rand_index"] == 1.0
    assert report["groups"] == {"a": 3, "b": 3, "c": 3}
    assert [cluster["groups"] for cluster in report["clusters"]] == [{"a": 3}, {"b": 3}, {"c": 3}]
    assert all(cluster["largest"] <= cluster["bound"] for cluster in report["clusters"])
    *alone, together = report["alone"]
    assert [(row["group"], row["ways"], row["left_out"]["n"]) for row in alone] == [
        ("a", 1, 3),
        ("b", 1, 3),
        ("c", 1, 3),
    ]
    assert (together["group"], together["ways"], together["left_out"]["n"]) == ("all", 3, 9)
    assert together["predicted"]["of_the_line"] < 1.0
    assert together["predicted"]["held_by_two_sd"]["n"] == 9


def test_every_array_is_a_group_and_the_table_says_what_was_found(
    tmp_path: Path, three_ways: dict[str, list[Trajectory]]
) -> None:
    for name, trajectories in three_ways.items():
        write_array(tmp_path / f"{name}.npy", trajectories)
    printed = called("evaluate", tmp_path)
    assert "9 demonstrations of 3 groups, 3 clusters found" in printed
    assert "adjusted Rand index 1.000" in printed
    assert all(f"3 {name} " in printed for name in "abc")
    assert printed.count("of 3 (0 to ") >= 3  # left out of each group alone, with its interval


def test_a_wrong_cut_is_told(tmp_path: Path, three_ways: dict[str, list[Trajectory]]) -> None:
    for name, trajectories in three_ways.items():
        write_array(tmp_path / f"{name}.npy", trajectories)
    report = json.loads(called("evaluate", tmp_path, "--mode", "paper", "--threshold", 10, "--json"))
    assert report["mode"] == "paper"
    assert report["adjusted_rand_index"] == 0.0
    (only,) = report["clusters"]
    assert only["groups"] == {"a": 3, "b": 3, "c": 3}
    assert any("the points zigzag" in flag for flag in only["flags"])


def test_mode_paper_asks_for_its_threshold(tmp_path: Path, three_ways: dict[str, list[Trajectory]]) -> None:
    write_array(tmp_path / "a.npy", three_ways["a"])
    with pytest.raises(UnusableSettings, match=r"set learning\.threshold"):
        called("evaluate", tmp_path, "--mode", "paper")


def test_flags_name_who_was_left_out_and_why() -> None:
    demonstrations = {f"g/{k}": d for k, d in synthetic.experiment_2(11).items()}
    (cluster,) = evaluation(learn(demonstrations, QUICK_SETTINGS))["clusters"]
    named = [flag for flag in cluster["flags"] if ": inconsistent in its " in flag]
    assert len(named) == 5 - cluster["selected"]
    assert any(flag.startswith("g/5: inconsistent in its smoothness") for flag in named)


@pytest.mark.parametrize(
    ("files", "format", "sentence"),
    [
        ([], "", "holds no .csv or .npy files"),
        (["a.txt"], "csv", "holds no .csv files"),
        (["a.csv", "b.npy"], "", "holds csv and robottasks files; say which with --format"),
        (["a.csv"], "bag", "format 'bag' is unknown"),
        (["a.csv"], "", "a.csv: the file is empty"),
    ],
)
def test_a_folder_that_cannot_be_read_is_refused(tmp_path: Path, files: list[str], format: str, sentence: str) -> None:
    for name in files:
        (tmp_path / name).touch()
    with pytest.raises(UnusableRecording, match=sentence):
        read_groups(tmp_path, format, units="", rate=50.0)


def test_a_folder_that_is_none_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UnusableRecording, match="is not a folder"):
        read_groups(tmp_path / "nowhere", "", units="", rate=50.0)


def test_the_index_is_that_of_scikit_learn() -> None:
    rng = np.random.default_rng(1)
    for count in (2, 3, 10, 60):
        for _ in range(20):
            one, other = rng.integers(0, rng.integers(1, 6, 2)[:, None], (2, count)).tolist()
            assert adjusted_rand_index(one, other) == pytest.approx(adjusted_rand_score(one, other))


def test_the_index_is_one_for_equal_partitions_whatever_their_names() -> None:
    assert adjusted_rand_index(["a", "b", "a", "c"], [3, 1, 3, 2]) == 1.0
    assert adjusted_rand_index([1], ["a"]) == 1.0


def stored(folder: Path, *results: Learned) -> list[str]:
    store = Store(StoreSettings(data_dir=str(folder)))
    store.ensure_task("t", scene="empty", calibration="identity")
    runs = []
    for number, learned in enumerate(results):
        store.add_job(Job(f"learn-{number}", "t", "learn", {}, JobState.RUNNING, 0.0, "", "", 0, 1, 0))
        runs.append(store.finish_learning(f"learn-{number}", learned))
    store.close()
    return runs


def test_diff_says_why_two_stored_runs_differ(tmp_path: Path) -> None:
    demonstrations = synthetic.experiment_2(11)
    one = learn(demonstrations, QUICK_SETTINGS)
    fewer = {name: demonstrations[name] for name in "1345"}
    other = learn(fewer, replace(QUICK_SETTINGS, error_bound=0.01))
    runs = stored(tmp_path / "data", one, other)
    printed = called("diff", *runs, "--data", tmp_path / "data")
    assert "demonstration 2 is no longer learned from" in printed
    assert "setting error_bound: 0.005 became 0.01" in printed
    assert called("diff", runs[0], runs[0], "--data", tmp_path / "data") == "the two runs are the same\n"


def test_diff_of_a_run_that_is_not_there_is_refused(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    with pytest.raises(NotFound, match="run 'run-9'"):
        called("diff", "run-9", "run-8", "--data", tmp_path / "data")
