"""A gripper that measures its fingers: one that closes on nothing, or has lost its object, ends or holds."""

from typing import Literal

import pytest

from teachpath.records import Plan
from tests.unit.executor.executors import PERIOD_NS, Bench, standing, within_limits

WIDTH = 0.04  # [m] of the block that the plan carries


def with_fingers(plan: Plan, closed: float | None, failed_grasp: Literal["fault", "hold"] = "fault") -> Bench:
    """A bench that is about to start a plan, with an arm whose fingers are so far apart when they have closed [m]."""
    bench = Bench(failed_grasp=failed_grasp)
    bench.closed_opening = closed
    bench.start(plan)
    return bench


def run(bench: Bench, until: str) -> None:
    bench.when(lambda: bench.state == until, bench.stop.set)
    bench.run()


def test_a_gripper_that_closes_on_nothing_ends_the_execution_before_the_path(middle: Plan) -> None:
    bench = with_fingers(middle, 0.001)
    run(bench, "faulted")
    last = bench.statuses[-1]
    assert last.progress == 0.0
    assert last.reason == (
        "the gripper closed on nothing (1 mm between the fingers, and block is 40 mm wide there): put block where the "
        "path begins, then start again"
    )
    assert standing(bench.setpoints)


def test_an_object_that_is_lost_on_the_way_ends_the_execution_at_rest_on_the_path(middle: Plan) -> None:
    bench = with_fingers(middle, WIDTH)
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "closed_opening", 0.0))
    run(bench, "faulted")
    last = bench.statuses[-1]
    assert 0.0 < last.progress < 1.0
    assert "the gripper has lost block (0 mm between the fingers" in last.reason
    assert standing(bench.setpoints)
    assert within_limits(bench.setpoints)


@pytest.mark.parametrize("closed", [WIDTH, 0.6 * WIDTH, None])
def test_a_gripper_that_holds_or_does_not_measure_it_is_no_reason_to_stop(middle: Plan, closed: float | None) -> None:
    bench = with_fingers(middle, closed)
    run(bench, "ended")
    assert bench.statuses[-1].progress == 1.0


def test_a_short_wrong_measurement_is_passed_over(middle: Plan) -> None:
    bench = with_fingers(middle, WIDTH)
    begin = 0

    def lose() -> None:
        nonlocal begin
        begin, bench.closed_opening = bench.now, 0.0

    bench.when(lambda: bench.state == "following", lose)
    bench.when(lambda: bench.now - begin > 10 * PERIOD_NS, lambda: setattr(bench, "closed_opening", WIDTH))
    run(bench, "ended")
    assert bench.statuses[-1].progress == 1.0


def test_by_a_setting_a_grasp_that_failed_is_held_with_the_reason_and_goes_on_only_when_somebody_says_so(
    middle: Plan,
) -> None:
    bench = with_fingers(middle, 0.001, "hold")
    bench.when(lambda: bench.state == "held", lambda: None)
    begin: list[int] = []
    bench.when(lambda: True, lambda: begin.append(bench.now))
    bench.when(lambda: bench.now - begin[0] > 500 * PERIOD_NS, lambda: None)
    reasons: list[str] = []
    bench.when(lambda: bench.state == "held", lambda: reasons.append(bench.statuses[-1].reason))
    bench.when(lambda: True, lambda: bench.command("resume"))
    bench.when(lambda: bench.statuses[-1].progress > 0.2, lambda: setattr(bench, "closed_opening", WIDTH))
    bench.when(lambda: bench.statuses[-1].progress > 0.4, lambda: setattr(bench, "closed_opening", 0.0))
    bench.when(lambda: bench.state == "held", lambda: reasons.append(bench.statuses[-1].reason))
    bench.when(lambda: True, lambda: bench.command("resume"))
    run(bench, "ended")
    nothing, lost = reasons
    assert nothing.startswith("the gripper closed on nothing (1 mm")
    assert lost.startswith("the gripper has lost block (0 mm")
    assert all(reason.endswith("resume goes on as it is, stop ends here") for reason in reasons)
    assert [entry.answer for entry in bench.journal if entry.who == "the executor"] == reasons
    assert bench.statuses[-1].progress == 1.0
    assert within_limits(bench.setpoints)


def test_what_is_lost_while_the_arm_is_held_for_another_reason_is_told_before_it_goes_on(middle: Plan) -> None:
    bench = with_fingers(middle, WIDTH, "hold")
    bench.when(lambda: bench.state == "following", lambda: bench.command("hold"))
    bench.when(lambda: bench.state == "held", lambda: setattr(bench, "closed_opening", 0.0))
    bench.when(lambda: "has lost block" in bench.statuses[-1].reason, lambda: bench.command("resume"))
    run(bench, "ended")
