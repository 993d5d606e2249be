"""The tool may have any pose to the flange: what is computed for the one on joint 6's axis holds for every other."""

from dataclasses import fields, make_dataclass, replace
from typing import Any

import mujoco
import numpy as np
import pytest

from teachpath.config import load
from teachpath.errors import UnusableSettings
from teachpath.motion.analysis.log_check import _tool
from teachpath.motion.arm.geometry import ADAPTER_RADIUS, collision_solids
from teachpath.motion.arm.kinematics import inverse_kinematics, jacobian, tool_pose
from teachpath.motion.arm.mjcf import write_mjcf
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.mounting import check_mounting
from teachpath.motion.arm.tool_speed import monitored_points, point_speeds
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.planning.canonical import canonical
from teachpath.motion.settings import MotionSettings
from teachpath.records import Scene, Shape, ToolPose

ARM = Arm.of_variant()
HOME = np.array(MotionSettings().home)
H = 1e-6  # s, of differences


def random_tools(count: int) -> list[ToolPose]:
    chance = np.random.default_rng(12)
    turns = chance.normal(size=(count, 4))
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    places = chance.uniform(-0.3, 0.3, (count, 3))
    return [ToolPose(tuple(place.tolist()), tuple(turn.tolist())) for place, turn in zip(places, turns, strict=True)]


@pytest.fixture(scope="module")
def configurations() -> np.ndarray:
    return np.random.default_rng(15).uniform(ARM.limits.lower, ARM.limits.upper, (40, 6))


@pytest.mark.parametrize("tool", random_tools(20))
def test_all_branches_bring_any_tool_to_the_pose(tool: ToolPose, configurations: np.ndarray) -> None:
    arm = replace(ARM, tool=tool)
    poses = tool_pose(configurations, arm)
    solutions = inverse_kinematics(poses, arm)
    assert solutions.reach_excess.max() <= 1e-12
    np.testing.assert_allclose(tool_pose(solutions.joints, arm), np.repeat(poses[:, None], 8, axis=1), atol=1e-9)
    off = np.abs(np.exp(1j * solutions.joints) - np.exp(1j * configurations[:, None])).max(axis=2)
    assert off.min(axis=1).max() < 1e-9


@pytest.mark.parametrize("tool", random_tools(5))
def test_mujoco_has_the_tool_at_the_same_pose(tool: ToolPose, configurations: np.ndarray) -> None:
    arm = replace(ARM, tool=tool)
    spec = mujoco.MjSpec.from_string(write_mjcf(empty_scene(), arm))
    spec.body("link6").add_site(name="tool", pos=tool.position, quat=tool.orientation)
    model = spec.compile()
    data = mujoco.MjData(model)
    linear, angular = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    for q in configurations:
        data.qpos[:6] = q
        mujoco.mj_forward(model, data)
        pose, site = tool_pose(q, arm), data.site("tool")
        np.testing.assert_allclose(site.xpos, pose[:3, 3], atol=1e-12)
        np.testing.assert_allclose(site.xmat.reshape(3, 3), pose[:3, :3], atol=1e-12)
        mujoco.mj_jacSite(model, data, linear, angular, site.id)
        np.testing.assert_allclose(np.vstack([linear, angular])[:, :6], jacobian(q, arm), atol=1e-12)


@pytest.mark.parametrize("tool", random_tools(3))
def test_every_account_of_the_tool_is_the_same(tool: ToolPose, configurations: np.ndarray) -> None:
    arm = replace(ARM, tool=tool)
    places = tool_pose(configurations, arm)[:, :3, 3]
    np.testing.assert_allclose(_tool(configurations, arm), places, atol=1e-12)
    np.testing.assert_allclose(monitored_points(configurations, arm)[:, 3], places, atol=1e-12)
    rates = np.random.default_rng(3).uniform(-2.0, 2.0, configurations.shape)
    moved = tool_pose(configurations + H * rates, arm)[:, :3, 3] - tool_pose(configurations - H * rates, arm)[:, :3, 3]
    speeds = np.linalg.norm(moved, axis=1) / (2 * H)
    np.testing.assert_allclose(point_speeds(configurations, rates, arm)[:, 3], speeds, atol=1e-7)


@pytest.mark.parametrize("tool", random_tools(6))
def test_the_fingers_are_where_the_tool_is(tool: ToolPose) -> None:
    arm = replace(ARM, tool=tool)
    there = np.linalg.inv(arm.tool_matrix)
    usual, mounted = ([s for s in collision_solids(each) if "finger" in s.name] for each in (ARM, arm))
    for one, two in zip(usual, mounted, strict=True):
        seen = there[:3, :3] @ two.position + there[:3, 3]
        np.testing.assert_allclose(seen, np.array(one.position) - [0.0, 0.0, ARM.tool_length], atol=1e-12)
        np.testing.assert_allclose(there[:3, :3] @ two.opening_offset, one.opening_offset, atol=1e-12)


def test_what_holds_the_tool_is_kept_clear() -> None:
    arm = replace(ARM, tool=ToolPose((0.0, 0.2, 0.15), (1.0, 0.0, 0.0, 0.0)))  # the adapter runs straight along y
    pose = tool_pose(HOME, arm)
    beside = pose[:3, :3] @ [-0.045, -0.12, -0.13] + pose[:3, 3]
    ball = Scene("s", (Shape("ball", "sphere", (0.01,), tuple(beside.tolist())),))
    model = CollisionModel(ball, arm)
    least = model.clearances(HOME)[0]
    assert {least.body, least.other_body} == {"adapter", "ball"}
    assert least.distance == pytest.approx(0.045 - ADAPTER_RADIUS - 0.01, abs=1e-6)


def test_a_gripper_in_the_wrist_is_refused_and_one_that_would_swing_into_the_forearm_too() -> None:
    inside = MotionSettings(tool_position=(0.0, 0.0, -0.2), tool_orientation=(0.0, 1.0, 0.0, 0.0))
    with pytest.raises(
        UnusableSettings, match=r"would stand \d+\.\d mm in the wrist: it sits tool_length \(130 mm\) behind"
    ):
        check_mounting(Arm.of_settings(inside))
    with pytest.raises(UnusableSettings, match="in the wrist"):
        load(document={"motion": {"tool_position": [0.0, 0.0, -0.2], "tool_orientation": [0.0, 1.0, 0.0, 0.0]}})
    back = replace(ARM, tool=ToolPose((0.08, 0.0, -0.14), (0.0, 1.0, 0.0, 0.0)))
    check_mounting(back)
    turned = np.tile(HOME, (24, 1))
    turned[:, 5] += np.linspace(0.0, 2 * np.pi, 24)
    assert min(row.distance for row in CollisionModel(empty_scene(), back).clearances(turned)) < 0.0


def test_a_later_field_changes_no_digest_of_arms_without_it() -> None:
    former = make_dataclass("former", [(f.name, Any) for f in fields(ARM) if "later" not in f.metadata], frozen=True)
    same = former(**{f.name: getattr(ARM, f.name) for f in fields(former)})
    assert canonical(same) == canonical(ARM)
    other = replace(ARM, tool=ToolPose((0.0, 0.0, 0.2), (1.0, 0.0, 0.0, 0.0)))
    assert canonical(other) != canonical(ARM)


def test_a_tool_straight_ahead_is_the_usual_arm() -> None:
    settings = MotionSettings(tool_position=(0.0, 0.0, 0.13), tool_orientation=(1.0, 0.0, 0.0, 0.0))
    assert Arm.of_settings(settings) == ARM
