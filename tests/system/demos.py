"""The demo as the tests start it, and what it must leave behind."""

import json
from collections.abc import Callable

from teachpath.executor.settings import ExecutorSettings
from teachpath.learning.settings import LearningSettings
from tests.system.processes import Command

Start = Callable[..., Command]


def assert_nothing_left(command: Command) -> None:
    command.wait_gone()
    assert list(command.temporary.iterdir()) == []


def assert_story(out: str) -> None:
    summary = json.loads(out)
    assert (summary["demonstrations"], summary["lost_samples"]) == (12, 0)
    assert sorted(summary["clusters"]) == [3, 4, 5]
    assert len(summary["selected"]) == len(summary["paths"]) == 3
    assert min(summary["selected"]) >= 2
    assert max(path["largest_error_m"] for path in summary["paths"]) <= LearningSettings().error_bound
    assert summary["planned_path"] in [path["id"] for path in summary["paths"]]
    assert summary["execution"] == "ended"
    assert 0 < summary["largest_limit_use"] <= 1.0
    assert 0 < summary["largest_tracking_error_rad"] < ExecutorSettings().largest_error
    assert summary["setpoints"] / ExecutorSettings().rate > summary["plan_duration_s"]
