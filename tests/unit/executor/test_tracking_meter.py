"""The arm is measured against the setpoints that were sent, whatever its driver says that it wanted."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.executor.tracking_meter import MAX_AGE, TrackingMeter
from teachpath.records import JointState, Plan, Setpoint
from tests.unit.executor.executors import Bench

RATE = 250.0
STEP = np.array([0.01, -0.004, 0.0, 0.002, 0.0, 0.0])


def setpoint(cycle: int) -> Setpoint:
    way = np.zeros((5, 3, 6))
    way[:, 0] = cycle * STEP + np.linspace(0.2, 1.0, 5)[:, None] * STEP
    zero = np.zeros(6)
    return Setpoint(cycle, 0, 0, cycle * STEP, zero, zero, False, "run-1", way_to_rest=way)


def arm(cycle: int, position: np.ndarray) -> JointState:
    zero = np.zeros(6)
    return JointState(0, cycle, position, zero, zero, 0.0, 0, False, False, (0.0,) * 3, (0.0,) * 4, "run-1")


@pytest.fixture
def bench() -> Bench:
    return Bench()


@pytest.fixture
def meter() -> TrackingMeter:
    meter = TrackingMeter(RATE)
    for cycle in range(400):
        meter.add(setpoint(cycle))
    return meter


@pytest.mark.parametrize("share", [0.0, 0.4, 1.0])
def test_between_two_setpoints_it_is_on_them(meter: TrackingMeter, share: float) -> None:
    here = (300 + share) * STEP
    assert meter.distance(arm(300, here)) < 1e-12
    off = np.array([0.0, 0.0, 0.03, 0.0, -0.05, 0.0])  # at right angles to the motion
    assert meter.distance(arm(300, here + off)) == pytest.approx(0.05)


def test_it_may_be_ahead_as_far_as_something_was_sent_and_not_behind(meter: TrackingMeter) -> None:
    for cycle, where, off in ((300, 297, 0.03), (300, 310.5, 0.0), (396, 403, 0.04), (399, 400, 0.0)):
        assert meter.distance(arm(cycle, where * STEP)) == pytest.approx(off)


@pytest.mark.parametrize("follows", [False, True])
def test_it_may_be_on_the_way_to_rest_of_what_it_has_reached(follows: bool) -> None:
    meter, aside = TrackingMeter(RATE), np.array([0.0, 0.0, 0.01, 0.0, 0.0, 0.0])
    meter.add(setpoint(0))
    if follows:  # it goes on elsewhere
        meter.add(replace(setpoint(1), position=aside))
    assert meter.distance(arm(0, 0.7 * STEP)) < 1e-12
    assert meter.distance(arm(0, 1.5 * STEP)) == pytest.approx(0.005)


def test_of_a_setpoint_that_is_not_known_it_says_nothing(meter: TrackingMeter) -> None:
    for cycle in (400, 399 - round(MAX_AGE * RATE), -1):
        assert meter.distance(arm(cycle, np.ones(6))) == 0.0
    assert TrackingMeter(RATE).distance(arm(0, np.ones(6))) == 0.0


def test_an_arm_that_reports_no_error_but_stands_elsewhere_ends_the_execution(bench: Bench, middle: Plan) -> None:
    def push() -> None:
        bench.pushed = 0.15

    bench.start(middle)
    bench.when(lambda: bench.state == "following", push)
    bench.when(lambda: bench.state == "faulted", bench.stop.set)
    bench.run()
    assert "tracking error 0.1" in bench.statuses[-1].reason
    assert bench.statuses[-1].tracking_error == pytest.approx(0.15, abs=0.02)
