"""The arm of a user's model is drawn in one piece, and what is only drawn is in no check."""

from itertools import pairwise

import numpy as np
import pytest

import teachpath
from teachpath.motion.arm.connectors import connectors
from teachpath.motion.arm.geometry import collision_solids, visual_solids
from teachpath.motion.arm.kinematics import link_frames
from teachpath.motion.arm.model import Arm
from teachpath.motion.settings import MotionSettings

BASE = ((0.1, -0.2, 0.5), (0.8, 0.0, 0.6, 0.0))


@pytest.mark.parametrize(("name", "gripper"), [("six-axis", 0.0), ("six-axis", 0.13), ("seven-axis", 0.0)])
def test_each_connector_begins_where_the_one_before_ends_however_the_joints_turn(name: str, gripper: float) -> None:
    arm = Arm.of_model(teachpath.read_arm(name, base=BASE, gripper_length=gripper), MotionSettings())
    made = connectors(arm)
    for seed in range(20):
        q = np.random.default_rng(seed).uniform(-3, 3, len(arm.limits.lower))
        drawn = [f[:3, :3] @ one.points.T + f[:3, 3:] for f, one in zip(link_frames(q, arm), made, strict=True)]
        np.testing.assert_allclose(drawn[0][:, 0], BASE[0], atol=1e-12)
        for before, after in pairwise(drawn):
            np.testing.assert_allclose(after[:, 0], before[:, -1], atol=1e-12)


def test_what_joins_the_links_is_thinner_than_they_are_and_collides_with_nothing() -> None:
    arm = Arm.of_model(teachpath.read_arm("six-axis", base=BASE, gripper_length=0.13), MotionSettings())
    joints = {solid.name for solid in visual_solids(arm)} - {solid.name for solid in collision_solids(arm)}
    assert joints == {solid.name for solid in visual_solids(arm) if solid.name.startswith(("rod ", "ball "))}
    assert len(joints) == len([solid for solid in visual_solids(arm) if solid.visual_only])  # each has its own name
    for one in connectors(arm)[:5]:
        joined = [solid for solid in collision_solids(arm) if solid.link in (one.link, one.link + 1)]
        assert one.radius < min(min(solid.size) for solid in joined)
