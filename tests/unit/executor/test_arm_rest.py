"""An execution has ended when the arm itself rests; an arm that does not come to rest is a fault."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from teachpath.executor.settings import ExecutorSettings
from teachpath.records import Plan
from tests.unit.executor.executors import PERIOD_NS, Bench, standing

MOVING_SPEED = 0.4  # [rad/s]
TIMEOUT = ExecutorSettings().rest_timeout


@pytest.fixture
def bench() -> Bench:
    return Bench()


def is_sent(bench: Bench) -> bool:
    """Whether all setpoints of the motion were sent."""
    current = bench.executor._command_handler.current
    return current is not None and current.program.finished


def go_on_moving(bench: Bench, plan: Plan, then: Callable[[], object] = lambda: None) -> None:
    """Start a plan with an arm that still moves when the last setpoint of the motion was sent; then do something."""
    bench.start(plan)
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "velocity", MOVING_SPEED))
    bench.when(lambda: is_sent(bench), then)


def test_an_arm_that_comes_to_rest_later_has_ended_then(bench: Bench, middle: Plan) -> None:
    times: list[int] = []

    def rest() -> None:
        times.append(bench.now)
        assert "ended" not in bench.states()
        bench.velocity = 0.0

    go_on_moving(bench, middle, lambda: times.append(bench.now))
    bench.when(lambda: bench.now - times[0] > 0.75e9 * TIMEOUT, rest)
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert bench.states() == ["idle", "approaching", "following", "ended"]
    assert bench.statuses[-1].reason == ""
    assert bench.now - times[1] <= 10 * PERIOD_NS


def test_an_arm_that_plays_its_setpoints_late_has_ended_when_it_has_played_the_last(bench: Bench, middle: Plan) -> None:
    bench.behind = 40
    bench.start(middle)
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert standing([bench.taken()])
    assert standing(bench.setpoints[-41:])


def test_an_arm_that_never_rests_is_a_fault_after_a_time(bench: Bench, middle: Plan) -> None:
    times: list[int] = []
    go_on_moving(bench, middle, lambda: times.append(bench.now))
    bench.when(lambda: bench.state == "faulted", bench.stop.set)
    bench.run()
    assert "ended" not in bench.states()
    reason = "the arm still moves at 0.40 rad/s: what moves it? look at the arm, then start again"
    assert bench.statuses[-1].reason == reason
    assert (bench.now - times[0]) / 1e9 == pytest.approx(TIMEOUT, abs=0.1)


def test_a_stop_of_an_arm_that_never_rests_names_both(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "velocity", MOVING_SPEED))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "faulted", bench.stop.set)
    bench.run()
    assert bench.states()[-2:] == ["stopping", "faulted"]
    assert bench.statuses[-1].reason.startswith("stopped by the operator; the arm still moves at 0.40 rad/s")


def test_an_arm_that_takes_up_no_end_of_its_motion_is_a_fault(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "deaf", bench.setpoints[-1]))
    bench.when(lambda: bench.state == "held", lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "faulted", bench.stop.set)
    bench.run()
    assert "the arm has not taken up the end of its motion" in bench.statuses[-1].reason


def test_an_arm_that_is_silent_at_the_end_is_a_fault(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "speaking", False))
    bench.when(lambda: bench.state == "held", lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "faulted", bench.stop.set)
    bench.run()
    reason = "no joint state says whether the arm rests: is its driver running? look at the arm, then start again"
    assert bench.statuses[-1].reason == f"stopped by the operator; {reason}"


@pytest.mark.parametrize("verb", ["hold", "resume", "reverse"])
def test_a_motion_that_was_sent_to_its_end_obeys_nothing_but_waits_for_the_arm(
    bench: Bench, middle: Plan, verb: str
) -> None:
    go_on_moving(bench, middle, lambda: bench.command(verb))
    bench.when(lambda: True, lambda: None)
    bench.when(lambda: True, lambda: setattr(bench, "velocity", 0.0))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert bench.states() == ["idle", "approaching", "following", "ended"]
    assert bench.statuses[-1].reason == ""


def test_a_stopped_arm_that_cannot_follow_ends_where_it_rests(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "drives", {"enabled": False}))
    bench.when(lambda: bench.state == "held", lambda: setattr(bench, "deaf", replace(bench.setpoints[-1])))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert bench.statuses[-1].reason == "stopped by the operator"
