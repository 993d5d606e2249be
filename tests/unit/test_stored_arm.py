"""The arm that the settings name, as the station and the processes beside it have it."""

from typing import Any

import numpy as np
import pytest

from teachpath.config import Settings, load
from teachpath.errors import UnusableSettings
from teachpath.instructions import Instructions, from_instructions, instructions
from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.io.store.store import Store
from teachpath.motion.arm.model import Arm
from teachpath.stored_arm import with_stored_arm

HIGH_PLACE = ((0.0, 0.0, 0.5), (1.0, 0.0, 0.0, 0.0))


def settings(**motion: Any) -> Settings:
    return load(document={"motion": {"arm": "light", **motion}})


def test_the_newest_version_is_the_arm_of_the_station_and_of_the_processes_beside_it(store: Store) -> None:
    store.arms.add(read_arm("six-axis", name="light"), "six_axis.urdf")
    newest = store.arms.add(read_arm("six-axis", name="light", base=HIGH_PLACE, gripper_length=0.13), "six_axis.urdf")
    found = with_stored_arm(settings(tool_speed=0.25), store.arms)
    assert found.arm.identity == f"light ({newest.hash[:12]})"
    assert found.arm.has_gripper
    assert found.arm.tool_speed == 0.25
    middle = (found.arm.limits.lower + found.arm.limits.upper) / 2
    np.testing.assert_array_equal(found.motion.home, middle)
    given = from_instructions(instructions(Instructions(found, None, b"key")))
    assert (given.settings, given.settings.arm) == (found, found.arm)


def test_a_home_that_was_said_stays_and_without_a_name_nothing_changes(store: Store) -> None:
    store.arms.add(read_arm("six-axis", name="light"), "six_axis.urdf")
    home = (0.0, -0.5, 1.0, 0.0, 0.0, 0.0)
    assert with_stored_arm(settings(home=home), store.arms).motion.home == home
    default = Settings()
    assert with_stored_arm(default, store.arms) is default
    assert from_instructions(instructions(Instructions(default, None))).settings.arm == Arm.of_variant()


def test_what_is_no_arm_of_a_station_is_a_sentence(store: Store) -> None:
    with pytest.raises(
        UnusableSettings, match=r"motion.arm is 'light', and no arm of that name is kept \(kept: none\)"
    ):
        with_stored_arm(settings(), store.arms)
    with pytest.raises(UnusableSettings, match=r"motion.arm is 'light', an arm that is kept in a data folder"):
        Arm.of_settings(settings().motion)
    store.arms.add(read_arm("seven-axis", name="light"), "seven_axis.xml")
    with pytest.raises(UnusableSettings, match=r"motion.home has 6 angles, and the arm light 7 joints"):
        with_stored_arm(settings(home=(0.0, 0.5, 1.0, 0.0, 0.0, 0.0)), store.arms)
    store.arms.add(read_arm("six-axis", name="light"), "six_axis.urdf")
    with pytest.raises(UnusableSettings, match=r"motion.tool_length is 0.2, and motion.arm is 'light': leave out"):
        with_stored_arm(settings(tool_length=0.2), store.arms)
    with pytest.raises(UnusableSettings, match=r"motion.home puts forearm_joint to 3.000 rad, limits -2.800 to 2.800"):
        with_stored_arm(settings(home=(0.0, 0.0, 3.0, 0.0, 0.0, 0.0)), store.arms)
