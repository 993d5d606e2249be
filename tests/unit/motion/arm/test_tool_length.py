"""The tool centre point is a setting: it follows the path, whatever its distance from the flange."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.config import load
from teachpath.errors import PathRefused, UnusableSettings
from teachpath.motion.arm.kinematics import link_frames
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.motion.planning.digest import verify
from teachpath.motion.planning.plan import plan
from teachpath.motion.settings import MotionSettings
from tests.unit.motion.ways import MIDDLE, way


@pytest.mark.parametrize("tool_length", [0.125, 0.13, 0.2])
def test_the_point_at_that_distance_follows_the_path(tool_length: float) -> None:
    settings = replace(MotionSettings(), tool_length=tool_length)
    made = plan(way(MIDDLE, height=0.7), empty_scene(), settings)
    flange = link_frames(made.joints, Arm.of_settings(settings))[:, 6]
    tips = (flange @ np.array([0.0, 0.0, tool_length, 1.0]))[[0, -1], :3]
    np.testing.assert_allclose(tips, way(MIDDLE).curve.control_points[[0, -1]], atol=1e-6)
    verify(made, Arm.of_settings(settings))
    with pytest.raises(PathRefused, match="tool_length"):
        verify(made, Arm.of_settings(replace(settings, tool_length=tool_length + 0.001)))


def test_a_point_beyond_the_fingers_grasps_nothing() -> None:
    with pytest.raises(PathRefused, match="finger"):
        plan(way(MIDDLE), paper_scene(), replace(MotionSettings(), tool_length=0.2))


@pytest.mark.parametrize(
    ("setting", "value", "limit"),
    [
        ("tool_length", 0.6, "less than or equal to 0.5"),
        ("tool_position", [0.0, 5.0, 0.1], "less than or equal to 0.5"),
        ("tool_position", [0.0, float("nan"), 0.1], "finite|greater than"),
        ("tool_position", [0.0, 0.1], "at least 3 items"),
        ("tool_orientation", [1.0, 2.0, 0.0, 0.0], "less than or equal to 1"),
        ("payload_mass", -1.0, "greater than or equal to 0"),
        ("payload_mass", 12.0, "less than or equal to 10"),
        ("payload_center", [0.0, 0.0, 0.9], "less than or equal to 0.5"),
        ("payload_center", [0.0, 0.1], "at least 3 items"),
        ("tool_speed", 0.0, "greater than or equal to 0.01"),
    ],
)
def test_bad_values_are_refused_with_the_limit(setting: str, value: object, limit: str) -> None:
    with pytest.raises(UnusableSettings, match=rf"setting motion\.{setting}.* {limit}"):
        load(document={"motion": {setting: value}})


def test_an_orientation_that_is_no_rotation_is_refused_with_the_way_out() -> None:
    for load_or_make in (
        lambda: load(document={"motion": {"tool_orientation": [1.0, 1.0, 0.0, 0.0]}}),
        lambda: Arm.of_settings(MotionSettings(tool_orientation=(1.0, 1.0, 0.0, 0.0))),
    ):
        with pytest.raises(UnusableSettings, match=r"motion\.tool_orientation.* has length 1\.414: divide it"):
            load_or_make()


@pytest.mark.parametrize("value", [5.0, float("inf"), float("nan")])
def test_a_tool_too_far_away_is_refused_whoever_makes_the_arm(value: float) -> None:
    with pytest.raises(UnusableSettings, match=r"motion\.tool_position is .* at most 0\.5 m"):
        Arm.of_settings(MotionSettings(tool_position=(0.0, 0.0, value)))
