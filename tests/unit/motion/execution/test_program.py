from dataclasses import replace

import numpy as np
import pytest

from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.execution.motion_preview import preview_motion
from teachpath.motion.execution.program import PlanProgram
from teachpath.motion.planning.certificate import plan_trajectory
from teachpath.motion.planning.digest import digest
from teachpath.motion.planning.plan import plan
from teachpath.motion.settings import MotionSettings
from teachpath.records import Plan
from tests.unit.motion.ways import MIDDLE, way

ARM = Arm.of_variant()

SETTINGS = MotionSettings()


@pytest.fixture(scope="module")
def slower() -> list[Plan]:
    """One plan at several paces; the tables of some end a last bit away from the length of the path."""
    made = plan(way(MIDDLE), paper_scene())
    paces = [replace(made, squared_rates=made.squared_rates * share) for share in np.linspace(0.5, 1.0, 20)]
    timed = [replace(one, duration=plan_trajectory(one).duration) for one in paces]
    return [replace(one, certificate=replace(one.certificate, digest=digest(one, ARM))) for one in timed]


def test_whoever_has_done_all_has_done_exactly_one_whatever_the_last_bit_of_the_table(slower: list[Plan]) -> None:
    for made in slower:
        program = PlanProgram(made, np.array(SETTINGS.home), SETTINGS, ARM)
        while not program.finished:
            program.step()
        assert (program.progress, program.arc_length) == (1.0, made.lengths[-1])


def test_what_is_rehearsed_goes_from_nothing_to_one_and_never_back(slower: list[Plan]) -> None:
    for made in slower:
        progress = preview_motion(made, SETTINGS, ARM, dwell=0.5).progress
        assert (progress[0], progress[-1]) == (0.0, 1.0)
        assert np.all(np.diff(progress) >= 0.0)


def test_a_motion_that_rests_on_its_way_back_is_back_at_the_beginning_only_there(middle: Plan) -> None:
    program = PlanProgram(middle, np.array(SETTINGS.home), SETTINGS, ARM)
    while program.progress < 0.4:
        program.step()
    program.reverse()
    while program.progress > 0.2:
        program.step()
    program.set_waiting(True)  # the arm is late
    while not program.at_rest:
        program.step()
    program.set_waiting(False)
    assert not program.held
    assert program.hold_reason == ""  # it is asked for before the next step, too, where the arm was held
    while not program.held:
        program.step()
    assert program.progress == 0.0
    assert program.hold_reason.startswith("back at the beginning")


def test_a_step_never_says_that_the_arm_is_farther_than_it_goes(middle: Plan) -> None:
    program = PlanProgram(middle, np.array(SETTINGS.home), SETTINGS, ARM)
    while not (program.state.on_path and program.arc_length > 0.1):
        program.step()
    program.hold()
    while not program.at_rest:
        program.step()
    begin = program.arc_length
    program.start_detour(program.plan_step(length=0.01))
    lengths = []
    while not program.held:
        program.step()
        lengths.append(program.arc_length)
    assert max(lengths) == pytest.approx(begin + 0.01, abs=1e-6)
