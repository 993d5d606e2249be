"""An arm that says that it can follow no setpoint is held, or its execution ends, with the reason and the way out."""

from typing import Any

import pytest

from teachpath.errors import Conflict
from teachpath.records import Plan
from tests.unit.executor.executors import Bench, standing, within_limits

HELD_CASES = [({"enabled": False}, "drives are off"), ({"protective_stop": True}, "protective stop")]


@pytest.mark.parametrize(("drives", "reason"), HELD_CASES)
def test_an_arm_that_cannot_follow_is_held_until_it_can(middle: Plan, drives: dict[str, Any], reason: str) -> None:
    bench, refused = Bench(), []

    def resume_too_early() -> None:
        with pytest.raises(Conflict, match=reason) as error:
            bench.command("resume")
        refused.append(str(error.value))
        bench.drives = {}

    bench.start(middle)
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "drives", drives))
    bench.when(lambda: bench.state == "held", resume_too_early)
    bench.when(lambda: bool(refused), lambda: None)  # a joint state later
    bench.when(lambda: bool(refused), lambda: bench.command("resume"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    held = next(status for status in bench.statuses if status.state == "held")
    assert reason in held.reason
    assert held.reason.endswith("then resume")
    assert bench.statuses[-1].progress == 1.0
    assert within_limits(bench.setpoints)


def test_a_fault_of_the_arm_ends_the_execution_at_rest(middle: Plan) -> None:
    bench = Bench()
    bench.start(middle)
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "drives", {"fault": "joint 2 is hot"}))
    bench.when(lambda: bench.state == "faulted", bench.stop.set)
    bench.run()
    assert bench.states()[-2:] == ["stopping", "faulted"]
    assert bench.statuses[-1].reason == "the arm reports a fault: joint 2 is hot; clear it at the arm, then start again"
    assert standing(bench.setpoints)
    assert within_limits(bench.setpoints)


@pytest.mark.parametrize(("drives", "reason"), [*HELD_CASES, ({"fault": "joint 2 is hot"}, "joint 2 is hot")])
def test_an_arm_that_cannot_follow_is_not_started(middle: Plan, drives: dict[str, Any], reason: str) -> None:
    bench = Bench()
    bench.drives = drives
    bench.start(middle)
    with pytest.raises(Conflict, match=reason):
        bench.run()
    assert bench.setpoints == []
