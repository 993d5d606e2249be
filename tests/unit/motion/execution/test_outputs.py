"""An output is on while the path is followed forward, in its rests at both ends, and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import UnusableInput
from teachpath.motion.arm.model import Arm
from teachpath.motion.execution.program import PlanProgram
from teachpath.motion.execution.segments import MotionState
from teachpath.motion.planning.digest import verify, with_digest
from teachpath.motion.settings import MotionSettings
from teachpath.records import Plan, ToolOutput

ARM, SETTINGS = Arm.of_variant(), MotionSettings()
START, END, PERIOD = 0.2, 0.1, 0.004


@pytest.fixture(scope="module")
def gluing(middle: Plan) -> Plan:
    made = with_digest(replace(middle, output=ToolOutput("glue", START, END)), ARM)
    verify(made, ARM)
    return made


def program_of(plan: Plan) -> PlanProgram:
    return PlanProgram(plan, np.array(SETTINGS.home), SETTINGS, ARM, period=PERIOD)


def on_the_path(program: PlanProgram, share: float) -> None:
    while program.progress < share:
        program.step()


def rests(program: PlanProgram) -> list[MotionState]:
    """Step until the nominal motion is at rest, and once more."""
    states = []
    while not program.at_rest:
        states.append(program.step())
    return [*states, program.step()]


def test_it_is_on_in_one_stretch_from_the_rest_at_the_start_to_the_rest_at_the_end(gluing: Plan) -> None:
    program, states = program_of(gluing), []
    while not program.finished:
        states.append(program.step())
    on = np.array([state.output == "glue" for state in states])
    path = np.array([state.on_path for state in states])
    first, last = np.flatnonzero(on)[[0, -1]]
    begin, end = np.flatnonzero(path)[[0, -1]]
    assert on[first : last + 1].all()
    assert (begin - first) * PERIOD == pytest.approx(START, abs=2 * PERIOD)
    assert (last - end) * PERIOD == pytest.approx(END, abs=2 * PERIOD)
    assert not any(states[k].velocity.any() for k in (*range(first, begin), *range(end + 1, last)))


def test_a_motion_that_is_held_switches_it_off_at_rest_and_on_when_it_goes_on(gluing: Plan) -> None:
    program = program_of(gluing)
    on_the_path(program, 0.4)
    program.hold()
    *braking, resting = rests(program)
    assert {state.output for state in braking[:-1]} == {"glue"}
    assert resting.output == ""
    program.resume()
    program.step()
    assert program.step().output == "glue"


def test_it_is_off_on_the_way_back_in_steps_and_after_a_way_to_rest(gluing: Plan) -> None:
    program = program_of(gluing)
    on_the_path(program, 0.4)
    _, point = program.way_to_rest()
    program.restart(point)
    assert program.state.output == ""
    program.hold()
    rests(program)
    program.start_detour(program.plan_step(length=0.01))
    stepped = [program.step()]
    while not program.held:
        stepped.append(program.step())
    assert any(state.velocity.any() for state in stepped)
    assert {state.output for state in stepped} == {""}
    program.reverse()
    assert {program.step().output for _ in range(20)} == {""}


def test_a_rest_that_is_held_switches_it_off(gluing: Plan) -> None:
    program = program_of(gluing)
    while not program.state.output:
        program.step()
    program.hold()
    assert program.step().output == ""
    program.resume()
    assert program.step().output == "glue"


def test_a_plan_with_an_output_is_another_plan(gluing: Plan, middle: Plan) -> None:
    assert gluing.certificate.digest != middle.certificate.digest


REFUSED_OUTPUTS = {
    "tool output": ("", 0.0, 0.0),
    "start of -1 s": ("glue", -1.0, 0.0),
    "end of 61 s": ("glue", 0.0, 61.0),
}


@pytest.mark.parametrize("said", REFUSED_OUTPUTS)
def test_an_output_without_a_name_or_with_an_endless_rest_is_refused(said: str) -> None:
    with pytest.raises(UnusableInput, match=said):
        ToolOutput(*REFUSED_OUTPUTS[said])
