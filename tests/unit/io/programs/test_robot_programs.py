"""Programs of robots: read back, they are the plan; where a controller cannot hold it, they are refused."""

import re
from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import UnusableInput
from teachpath.io.programs.formats import FORMATS
from teachpath.io.programs.robot_targets import MAX_DEVIATION, TARGETS, RobotTarget, check_target, largest_deviation
from teachpath.motion.arm.model import Arm
from teachpath.motion.planning.certificate import plan_trajectory
from teachpath.motion.planning.sampled_plan import sample_plan
from teachpath.records import Plan, SampledMotion
from tests.unit.io.programs.interpreters import INTERPRETERS
from tests.unit.io.programs.motions import a_motion

ARM = Arm.of_variant()
AWKWARD_NAME = "Plan “p”; in scene\n/END µm"


def still(rate: float, count: int = 5) -> SampledMotion:
    zero = np.zeros((count, 6))
    return replace(a_motion(count, rate), positions=zero + 0.1)


@pytest.mark.parametrize("name", TARGETS)
def test_a_program_read_back_is_the_plan(middle: Plan, name: str) -> None:
    motion = sample_plan(middle, FORMATS[name].rate, ARM)
    times, joints = INTERPRETERS[name](FORMATS[name].write(motion).decode("ascii"))
    np.testing.assert_allclose(times, motion.times, rtol=0, atol=1e-6)
    np.testing.assert_allclose(joints, plan_trajectory(middle)(motion.times)[:, :6], rtol=0, atol=1e-6)


@pytest.mark.parametrize("name", TARGETS)
def test_between_its_points_a_straight_line_keeps_the_deviation_that_is_allowed(middle: Plan, name: str) -> None:
    motion = sample_plan(middle, FORMATS[name].rate, ARM)
    fine = np.linspace(0.0, middle.duration, 4001)
    lines = np.column_stack([np.interp(fine, motion.times, joint) for joint in motion.positions.T])
    off = np.abs(lines - plan_trajectory(middle)(fine)[:, :6]).max()
    assert off <= 1.05 * largest_deviation(motion, TARGETS[name])[0] <= 1.05 * MAX_DEVIATION


@pytest.mark.parametrize("name", TARGETS)
def test_the_head_says_what_was_proved_and_what_was_not(middle: Plan, name: str) -> None:
    text = FORMATS[name].write(sample_plan(middle, FORMATS[name].rate, ARM)).decode("ascii")
    words = " ".join(re.sub(r"(?m)^ *(\d+:  !|[#!;] )|;$", " ", text).split())
    for said in (
        middle.certificate.digest[:16],
        "Not covered",
        ARM.name,
        "unless",
        "degrees" if TARGETS[name].degrees else "radians",
    ):
        assert said in words


@pytest.mark.parametrize("name", TARGETS)
def test_what_stands_in_a_note_does_not_end_a_remark(name: str) -> None:
    motion = replace(still(FORMATS[name].rate), name="ä plan; END", notes=(AWKWARD_NAME,))
    _, joints = INTERPRETERS[name](FORMATS[name].write(motion).decode("ascii"))
    assert joints.shape == (5, 6)


@pytest.mark.parametrize(
    ("name", "rate"), [("urscript", 333.0), ("urscript", 1000.0), ("rapid", 1000.0), ("ls", 100.0), ("krl", 60.0)]
)
def test_a_period_that_a_controller_does_not_have_is_refused_with_one_that_it_has(name: str, rate: float) -> None:
    with pytest.raises(UnusableInput, match="takes whole multiples of") as refused:
        FORMATS[name].write(still(rate))
    check_target(still(float(str(refused.value).split("ask for ")[1].split()[0])), TARGETS[name])


@pytest.mark.parametrize("name", TARGETS)
def test_points_too_far_apart_are_refused_and_whoever_takes_the_advice_gets_there(middle: Plan, name: str) -> None:
    target = TARGETS[name]
    rates = [1.0 / (40 * target.cycle)]
    with pytest.raises(UnusableInput, match=r"may leave the plan by .* rad \(joint \d at .* s\), limit 0.002"):
        FORMATS[name].write(sample_plan(middle, rates[0], ARM))
    while advice := _advice(sample_plan(middle, rates[-1], ARM), target):
        assert advice > rates[-1]
        rates.append(advice)
    assert 2 <= len(rates) <= 4


def _advice(motion: SampledMotion, target: RobotTarget) -> float | None:
    """Return the rate that a refusal asks for [Hz]; None: it is none."""
    try:
        check_target(motion, target)
    except UnusableInput as refused:
        return float(str(refused).split("ask for ")[1].split()[0])
    return None


def test_what_no_rate_can_mend_says_so() -> None:
    motion = still(250.0 / 2)
    jump = replace(motion, positions=motion.positions + np.eye(5, 6))
    with pytest.raises(UnusableInput, match=r"plan the path slower \(motion.path_share\)"):
        FORMATS["ls"].write(jump)


def test_programs_have_a_largest_length_and_six_joints() -> None:
    with pytest.raises(UnusableInput, match="10000 points are over 9999"):
        FORMATS["ls"].write(still(125.0, 10_000))
    with pytest.raises(UnusableInput, match="the arm has 7 joints; programs of Fanuc, LS have 6"):
        FORMATS["ls"].write(replace(still(125.0), positions=np.zeros((5, 7))))
