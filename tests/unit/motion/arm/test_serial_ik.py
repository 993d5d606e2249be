import numpy as np
import pytest

from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.motion.arm.serial_ik import POSE_TOLERANCE, all_solutions, limits_of, pose_errors, solve_near
from teachpath.motion.arm.serial_kinematics import serial_tool_pose


@pytest.mark.parametrize("name", ["six-axis", "seven-axis"])
def test_every_solution_closes_within_the_limits(name: str) -> None:
    arm = read_arm(name)
    lower, upper = limits_of(arm)
    for q in np.random.default_rng(7).uniform(np.maximum(lower, -np.pi), np.minimum(upper, np.pi), (6, len(lower))):
        pose = serial_tool_pose(q, arm)
        found = all_solutions(pose, arm)
        assert len(found) >= 2
        assert np.abs(pose_errors(np.repeat(pose[None], len(found), axis=0), found, arm)).max() <= POSE_TOLERANCE
        assert np.all((found >= lower) & (found <= upper))
        for number, row in enumerate(found):
            others = np.delete(found, number, axis=0)
            assert np.abs(np.sin((others - row) / 2)).max(axis=1).min() > 1e-5


def test_of_six_axes_the_known_solution_is_found_and_more_seeds_find_no_more() -> None:
    arm = read_arm("six-axis")
    for q in np.random.default_rng(8).uniform(-2.5, 2.5, (5, 6)):
        pose = serial_tool_pose(q, arm)
        found = all_solutions(pose, arm)
        assert np.abs(np.sin((found - q) / 2)).max(axis=1).min() < 1e-6
        assert len(all_solutions(pose, arm, seeds=500)) == len(found)


def test_what_is_out_of_reach_is_said_to_be_missed() -> None:
    arm = read_arm("six-axis")
    pose = np.eye(4)
    pose[:3, 3] = [3.0, 0.0, 0.0]
    assert all_solutions(pose, arm).shape == (0, 6)
    _, off = solve_near(pose[None], np.full((1, 6), 0.3), arm)
    assert off[0] > 1.5


def test_a_half_turn_away_the_axis_is_found_all_the_same() -> None:
    arm = read_arm("six-axis")
    for q in np.random.default_rng(9).uniform(-1.5, 1.5, (4, 6)):
        for joint in (3, 5):
            turned = q + np.pi * (np.arange(6) == joint)  # by hardly a rounding more or less than a half turn
            found, off = solve_near(serial_tool_pose(turned, arm)[None], q[None], arm)
            assert off[0] <= POSE_TOLERANCE
            assert np.abs(pose_errors(serial_tool_pose(found, arm), turned[None], arm)).max() <= 1e-8
