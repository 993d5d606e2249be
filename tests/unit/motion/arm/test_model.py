import pickle

import numpy as np
import pytest

from teachpath.errors import UnusableSettings
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import VARIANTS


def test_arms_of_one_process_do_not_disturb_each_other() -> None:
    sideways = {name: tool_pose(np.zeros(6), Arm.of_variant(name))[1, 3] for name in (*VARIANTS, *VARIANTS)}
    assert {name: round(-y, 5) for name, y in sideways.items()} == {
        "corke-armstrong": 0.15005,
        "armstrong-khatib-burdick": 0.1501,
        "fu-gonzalez-lee": 0.14909,
        "corke-1996": 0.1254,
    }


def test_equal_arms_are_one_key_and_different_arms_are_not() -> None:
    arms = [Arm.of_variant(name) for name in VARIANTS] + [Arm.of_variant(name) for name in VARIANTS]
    assert len(set(arms)) == len(VARIANTS)
    longer = Arm(arms[0].name, arms[0].links, tool_length=arms[0].tool_length + 0.01)
    assert longer not in set(arms)


def test_an_arm_goes_to_another_process_whole() -> None:
    arm = Arm.of_variant("corke-1996")
    assert arm.limits.lower[0] < 0.0  # computed already, which must not matter
    there = pickle.loads(pickle.dumps(arm))
    assert there == arm
    assert hash(there) == hash(arm)
    np.testing.assert_array_equal(there.limits.jerk, arm.limits.jerk)


def test_a_longer_tool_brings_the_grasp_point_out_along_its_axis() -> None:
    arm = Arm.of_variant()
    longer = Arm(arm.name, arm.links, tool_length=arm.tool_length + 0.05)
    q = np.array([0.3, 0.7, -2.2, 0.9, 1.1, -0.5])
    short, long = tool_pose(q, arm), tool_pose(q, longer)
    np.testing.assert_allclose(long[:3, 3], short[:3, 3] + 0.05 * short[:3, 2], atol=1e-12)
    np.testing.assert_array_equal(long[:3, :3], short[:3, :3])


def test_nobody_changes_the_limits_of_an_arm() -> None:
    with pytest.raises(ValueError, match="read-only"):
        Arm.of_variant().limits.speed[0] = 9.0


def test_a_variant_that_does_not_exist_is_refused_with_those_that_do() -> None:
    with pytest.raises(UnusableSettings, match="'stanford'; known: corke-armstrong, "):
        Arm.of_variant("stanford")
