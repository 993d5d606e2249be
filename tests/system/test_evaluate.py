"""Two stored runs compared through a running service, and from the same data folder beside it."""

from dataclasses import replace
from pathlib import Path

import pytest

from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from tests.system.processes import Service, run
from tests.unit.commands.test_evaluate import stored
from tests.unit.learning import synthetic

pytestmark = pytest.mark.system


def test_diff_says_the_same_over_rest_and_from_the_data_folder(tmp_path: Path) -> None:
    demonstrations = synthetic.experiment_2(11)
    settings = LearningSettings(repeats=0)
    looser = replace(settings, error_bound=0.01)
    runs = stored(tmp_path / "data", learn(demonstrations, settings), learn(demonstrations, looser))
    with Service(tmp_path / "data") as service:
        asked = run("diff", *runs, "--url", service.url, folder=tmp_path)
        read = run("diff", *runs, "--data", str(tmp_path / "data"), folder=tmp_path)
        missing = run("diff", runs[0], "moon", "--url", service.url, folder=tmp_path)
    assert (asked.err, read.err) == ("", "")
    assert asked.out == read.out
    assert asked.out.startswith("setting error_bound: 0.005 became 0.01\n")
    assert missing.process.returncode == 1
    assert missing.err == "teachpath: there is no run 'moon'; list them with: teachpath runs\n"
