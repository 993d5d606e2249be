"""A limit of the tool's speed holds in every motion of an execution, judged by numbers of the checker's own."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import PathRefused
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.tool_speed import difference_speeds
from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.motion.execution.program import PlanProgram
from teachpath.motion.planning.assessment import assess
from teachpath.motion.planning.digest import verify
from teachpath.motion.planning.plan import plan
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve
from teachpath.records import Plan
from tests.plan_checker.checker import judge, tool_speed
from tests.unit.motion.ways import MIDDLE, clamped, hooked, learned, wandering, way

RATE = 250.0
ROUNDING_FACTOR = 1.0 + 1e-6
# As near to singular poses as the arm can go: past its column, with elbow and wrist much faster than the tool, and at
# the end of its reach.
NEARLY_SINGULAR = replace(MotionSettings(), least_singular=0.003)
CURVES = {
    "past the column": clamped(np.linspace([0.24, -0.35, 0.8], [0.24, 0.35, 0.8], 8), degree=5),
    "at the reach": clamped(np.linspace([0.55, -0.3, 0.6], [0.86, 0.1, 0.62], 8), degree=5),
    "hooked": hooked(),
    "wandering": wandering(2),
}


def slowly(limit: float | None, settings: MotionSettings = NEARLY_SINGULAR) -> tuple[MotionSettings, Arm]:
    limited = replace(settings, tool_speed=limit)
    return limited, Arm.of_settings(limited)


def executed(made: Plan, settings: MotionSettings, arm: Arm, seed: int | None = None) -> np.ndarray:
    """The setpoints (n, 6) of a whole execution, with commands at random when there is a seed."""
    program = PlanProgram(made, np.array(settings.home), settings, arm, dwell=0.0, period=1 / RATE)
    sent = [program.current_q]
    rng = np.random.default_rng(seed)
    while not program.finished:
        if seed is not None and rng.random() < 0.05:
            (program.hold, program.reverse, program.resume, program.resume)[rng.integers(4)]()
            program.set_override(float(rng.choice([1.0, rng.uniform(0.3, 1.0)])))
        if seed is not None and len(sent) > 3000:
            seed = None
            program.resume()
            program.set_override(1.0)
        sent.append(program.step().position)
    return np.array(sent)


@pytest.mark.parametrize(("name", "limit"), [*zip(CURVES, [0.25, 0.25, 0.1, 0.5], strict=True)])
def test_no_motion_of_an_execution_is_faster(name: str, limit: float) -> None:
    settings, arm = slowly(limit)
    made = plan(learned(CURVES[name]), empty_scene(), settings)
    sent = executed(made, settings, arm)
    assert 0.9 * limit < tool_speed(sent) <= limit * ROUNDING_FACTOR
    assert difference_speeds(sent, RATE, arm).max() <= limit * ROUNDING_FACTOR
    assert made.certificate.tool_speed is not None
    assert made.certificate.tool_speed.value <= limit


def test_no_command_makes_it_faster() -> None:
    settings, arm = slowly(0.25)
    made = plan(way(MIDDLE), paper_scene(), settings)
    for seed in range(2):
        assert difference_speeds(executed(made, settings, arm, seed), RATE, arm).max() <= 0.25 * ROUNDING_FACTOR


def test_every_setpoint_has_a_way_to_rest_that_is_not_faster() -> None:
    settings, arm = slowly(0.25)
    made = plan(way(MIDDLE), paper_scene(), settings)
    program = PlanProgram(made, np.array(settings.home), settings, arm, dwell=0.0, period=1 / RATE)
    sent: list[np.ndarray] = []
    while not program.finished:
        sent.append(program.step().position)
        rest, _ = program.way_to_rest()
        if len(rest) and len(sent) % 3 == 0:
            assert difference_speeds(np.vstack([sent[-1], rest[:, 0]]), RATE, arm).max() <= 0.25 * ROUNDING_FACTOR
    assert len(sent) > 1000


def test_the_checker_notices_a_faster_motion_and_measures_the_elbow_too() -> None:
    settings, _ = slowly(0.25)
    made = plan(learned(CURVES["hooked"]), empty_scene(), settings)
    sent = executed(made, settings, Arm.of_settings(settings))
    assert judge(sent, CURVES["hooked"], empty_scene(), every=9999).tool_speed == tool_speed(sent)
    assert tool_speed(sent[::2]) > 0.25 * 1.5
    turned = np.zeros((2, 6))
    turned[1, 0] = 0.001
    assert tool_speed(turned) > 0.4318 * 0.001 * RATE  # joint 1 moves the elbow, too


def test_a_limit_that_nothing_reaches_costs_nothing_and_a_lower_one_takes_longer() -> None:
    def duration(limit: float | None) -> float:
        return plan(way(MIDDLE), paper_scene(), slowly(limit, MotionSettings())[0]).duration

    free, loose, slow, slower = (duration(limit) for limit in (None, 5.0, 0.25, 0.1))
    assert loose == pytest.approx(free, rel=1e-3)
    assert 2.0 * free < slow < 0.5 * slower


def test_a_plan_made_at_another_limit_is_for_another_arm() -> None:
    settings, arm = slowly(0.25, MotionSettings())
    made = plan(way(MIDDLE), paper_scene(), settings)
    verify(made, arm)
    for other in (None, 0.24, 1.0):
        with pytest.raises(PathRefused, match="plan the path again"):
            verify(made, replace(arm, tool_speed=other))
    with pytest.raises(PathRefused, match="plan the path again"):
        verify(replace(made, tool_speed=1.0), arm)


def test_an_assessment_knows_the_limit() -> None:
    curve: Curve = way(MIDDLE).curve
    free, slow = (assess(curve, paper_scene(), slowly(limit, MotionSettings())[0]).duration for limit in (None, 0.1))
    assert free is not None
    assert slow is not None
    assert slow > 2.0 * free
