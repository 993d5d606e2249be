"""A gripper that measures its fingers: an execution whose grasp closes on nothing, or loses its object, is faulted."""

import pytest

from teachpath.records import Plan
from tests.unit.executor.executors import PERIOD_NS, Bench, standing, within_limits

WIDTH = 0.04  # [m] of the block that the plan carries


def with_fingers(plan: Plan, closed: float | None) -> Bench:
    """A bench that is about to start a plan, with an arm whose fingers are so far apart when they have closed [m]."""
    bench = Bench()
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
