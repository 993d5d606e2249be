"""Which arm the demonstration moves."""

from pathlib import Path

import pytest

from teachpath.commands.demo import demo_settings
from teachpath.commands.demo_arm import prepare_arm
from teachpath.commands.options import opened_store, with_arm
from teachpath.errors import UnusableInput
from teachpath.io.arm_models.arm_reader import read_arm


def test_the_demonstration_moves_the_published_arm_that_is_named(tmp_path: Path) -> None:
    assert demo_settings(None, tmp_path, 1, "corke-1996").arm.name == "corke-1996"
    assert demo_settings(None, tmp_path, 1, "").arm.name == "corke-armstrong"


def test_an_example_is_added_with_a_gripper(tmp_path: Path) -> None:
    settings = demo_settings(None, tmp_path, 1, "six-axis")
    for _ in range(2):
        prepare_arm(settings, carries=True)
    with opened_store(settings) as store:
        (stored,) = store.arms.newest()
    assert (stored.version, with_arm(settings).arm.identity) == (1, f"six-axis ({stored.hash[:12]})")


def test_an_arm_that_cannot_carry_the_block_is_refused_before_anything_is_shown(tmp_path: Path) -> None:
    settings = demo_settings(None, tmp_path, 1, "light")
    with pytest.raises(
        UnusableInput, match=r"no arm 'light': published .* corke-armstrong, .*examples six-axis, seven"
    ):
        prepare_arm(settings, carries=True)
    with opened_store(settings) as store:
        store.arms.add(read_arm("six-axis", name="light"), "six_axis.urdf")
    with pytest.raises(UnusableInput, match="--arm light has no gripper, and the demo has a block to carry"):
        prepare_arm(settings, carries=True)
    prepare_arm(settings, carries=False)
