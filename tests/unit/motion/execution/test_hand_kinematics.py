"""A live hand leads arms from models, of six and seven joints, within all limits; the tool keeps its orientation."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.execution.hand_kinematics import WRIST, HandKinematics
from teachpath.motion.execution.teleop_follower import TeleopFollower
from teachpath.motion.settings import MotionSettings
from teachpath.records import Shape

BASE = ((0.05, 0.0, 0.5), (1.0, 0.0, 0.0, 0.0))
HOMES = {"six-axis": (0.0, -0.2, 1.9, -0.13, -1.57, 0.0), "seven-axis": (0.0, 0.0, 0.0, -1.55, 0.0, 1.55, 0.0)}
SETTINGS = MotionSettings()
DT, TARGET_STRIDE, SHARE = 0.004, 5, 0.5


@pytest.fixture(params=HOMES)
def led(request: pytest.FixtureRequest) -> tuple[Arm, np.ndarray]:
    """An arm, and where it rests."""
    arm = Arm.of_model(read_arm(request.param, base=BASE, gripper_length=0.13), SETTINGS)
    return arm, np.array(HOMES[request.param])


def follow(follower: TeleopFollower, hand: np.ndarray, periods: int) -> np.ndarray:
    """Hold the hand at a place; return the setpoints."""
    sent = []
    for k in range(periods):
        if k % TARGET_STRIDE == 0:
            follower.set_hand(hand, k)
        sent.append(follower.step()[0])
        follower.advance_planning()
    return np.array(sent)


def test_the_tool_comes_to_the_hand_within_all_limits_and_keeps_its_orientation(led: tuple[Arm, np.ndarray]) -> None:
    arm, home = led
    model, move = CollisionModel(empty_scene(), arm), np.array([-0.03, 0.05, -0.04])
    follower = TeleopFollower(model, home, SETTINGS, share=SHARE)
    follower.engage(np.zeros(3))
    sent, goal = np.tile(home, (3, 1)), tool_pose(home, arm)[:3, 3] + move
    while np.abs(tool_pose(sent[-1], arm)[:3, 3] - goal).max() > 1e-3:
        assert len(sent) < 1000, follower.reason
        sent = np.concatenate([sent, follow(follower, move, 10)])
    poses = tool_pose(sent, arm)
    np.testing.assert_allclose(poses[:, :3, :3] - poses[0, :3, :3], 0.0, atol=1e-4)
    limits = arm.limits
    assert np.all((sent >= limits.lower) & (sent <= limits.upper))
    for order, limit in enumerate((limits.speed, limits.acceleration, limits.jerk), 1):
        assert np.abs(np.diff(sent, order, axis=0) / DT**order / limit).max() <= SHARE * (1 + 1e-6)


def test_the_tool_stays_clear_of_what_the_hand_leads_it_into(led: tuple[Arm, np.ndarray]) -> None:
    arm, home = led
    x, y, z = tool_pose(home, arm)[:3, 3]
    wall = Shape("wall", "box", (0.02, 0.6, 0.6), (float(x) + 0.16, float(y), float(z)))
    model = CollisionModel(replace(empty_scene(), obstacles=(*empty_scene().obstacles, wall)), arm)
    follower = TeleopFollower(model, home, SETTINGS, share=1.0)
    follower.engage(np.zeros(3))
    sent = home[None]
    while "of wall" not in follower.reason:
        assert len(sent) < 1000, follower.reason
        sent = np.concatenate([sent, follow(follower, np.array([0.3, 0.0, 0.0]), 5)])
    assert min(row.distance for row in model.clearances(sent[::5])) >= SETTINGS.clearance_min


def test_the_wrist_alone_turns_the_tool_as_told(led: tuple[Arm, np.ndarray]) -> None:
    arm, home = led
    kinematics, rng = HandKinematics.at(home, arm, SETTINGS.least_singular), np.random.default_rng(3)
    q = home + np.cumsum(rng.uniform(-0.02, 0.02, (20, len(home))), axis=0)
    solved = kinematics.wrist(q[:, :-WRIST], tool_pose(q, arm)[:, :3, :3], home)
    np.testing.assert_allclose(solved, q[:, -WRIST:], atol=1e-8)
    poses = tool_pose(q, arm)
    joints, missed = kinematics.follow(home, poses[None])
    assert not missed.any()
    np.testing.assert_allclose(tool_pose(joints[0, 1:], arm), poses, atol=1e-9)
    poses[10:, 0, 3] += 2.0
    assert kinematics.follow(home, poses[None])[1].tolist() == [[False] * 10 + [True] * 10]
