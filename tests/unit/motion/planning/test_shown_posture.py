"""A plan keeps to the joints that a demonstration by an arm showed, where these can be certified."""

import numpy as np
import pytest

from teachpath.errors import UnusableInput
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.motion.paths.enumeration import enumerate_candidates
from teachpath.motion.paths.tool_path import sample_tool_path
from teachpath.motion.planning.candidates import usable_candidates
from teachpath.motion.planning.digest import verify
from teachpath.motion.planning.plan import plan
from teachpath.motion.planning.plan_notes import plan_notes
from teachpath.motion.settings import MotionSettings
from teachpath.records import Plan, ShownPosture
from tests.unit.motion.ways import clamped, learned

ARM = Arm.of_variant()
SETTINGS = MotionSettings()
PATH = learned(clamped(np.linspace([0.5, -0.2, 0.65], [0.5, 0.2, 0.65], 8), degree=5))
SCENE = empty_scene()


@pytest.fixture(scope="module")
def free() -> Plan:
    return plan(PATH, SCENE, SETTINGS, arm=ARM)


def planned(joints: np.ndarray) -> Plan:
    return plan(PATH, SCENE, SETTINGS, arm=ARM, shown=ShownPosture("d7", joints))


def test_the_posture_that_was_shown_is_taken_although_it_costs_more(free: Plan) -> None:
    tool_path = sample_tool_path(PATH.curve, SETTINGS)
    usable = usable_candidates(enumerate_candidates(tool_path, ARM, SETTINGS), SETTINGS)
    flipped = next(c for c in usable if np.abs(c.joints[0] - free.joints[0]).max() > 1.0 and c.joints[0, 1] > 1.0)
    shown = flipped.joints[::4] + 0.05  # as a hand leads it: not exactly
    made = planned(shown)
    assert made.posture is not None
    assert made.posture.demonstration == "d7"
    assert 0.04 < made.posture.distance.value < 0.1
    assert np.abs(made.joints[0] - flipped.joints[0]).max() < 1e-6
    assert "of the joints that demonstration d7 showed" in " ".join(plan_notes(made, ARM))
    verify(made, ARM)


def test_joints_that_no_arm_can_follow_here_do_not_hinder_a_plan_and_their_distance_is_said(free: Plan) -> None:
    made = planned(np.tile(ARM.limits.lower, (5, 1)))
    assert made.posture is not None
    assert made.posture.distance.value > 1.0
    assert made.certificate.clearance.value >= SETTINGS.clearance_min


def test_without_them_a_plan_says_nothing_of_a_posture(free: Plan) -> None:
    assert free.posture is None


def test_joints_of_an_arm_with_another_number_of_them_are_refused() -> None:
    with pytest.raises(UnusableInput, match=r"shown by an arm of 7 joints, and .* has 6"):
        planned(np.zeros((5, 7)))
