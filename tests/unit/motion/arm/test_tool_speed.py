"""Speeds of elbow, wrist and tool: their derivatives, and bounds of what lies between samples."""

import numpy as np
import pytest

from teachpath.motion.arm.kinematics import link_frames, tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.tool_speed import (
    difference_speeds,
    line_speed_bound,
    monitored_points,
    point_speeds,
    speed_bounds,
)

ARM = Arm.of_variant()


def test_the_points_lie_on_elbow_wrist_and_tool() -> None:
    q = np.random.default_rng(1).uniform(-2, 2, (50, 6))
    points, frames = monitored_points(q, ARM), link_frames(q, ARM)
    np.testing.assert_allclose(points[:, 3], tool_pose(q, ARM)[:, :3, 3], atol=1e-12)
    np.testing.assert_allclose(points[:, 2], frames[:, 5, :3, 3], atol=1e-12)  # the axes of joints 4 to 6 meet there
    elbow = np.cross(points[:, 1] - points[:, 0], frames[:, 2, :3, 2])
    np.testing.assert_allclose(elbow, 0.0, atol=1e-12)


def test_speeds_are_those_of_small_moves() -> None:
    rng = np.random.default_rng(2)
    q, velocity, step = rng.uniform(-2, 2, (50, 6)), rng.uniform(-3, 3, (50, 6)), 1e-6
    moved = monitored_points(q + step * velocity, ARM) - monitored_points(q - step * velocity, ARM)
    found = point_speeds(q, velocity, ARM)
    np.testing.assert_allclose(found, np.linalg.norm(moved, axis=2) / (2 * step), rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("seed", range(5))
def test_no_point_is_faster_between_two_samples_than_the_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    amplitude, phase, frequency = rng.uniform(0.1, 1.0, 6), rng.uniform(0, 6, 6), rng.uniform(1, 8, 6)

    def motion(t: np.ndarray) -> np.ndarray:
        angle = frequency * t[:, None] + phase
        waves = (np.sin(angle), np.cos(angle), -np.sin(angle), -np.cos(angle))
        return np.stack([amplitude * frequency**k * wave for k, wave in enumerate(waves)], axis=1)

    coarse, fine = np.linspace(0.0, 1.0, 51), np.linspace(0.0, 1.0, 5001)
    bounds = speed_bounds(motion(coarse), 0.02, ARM)
    between = np.maximum(bounds[:-1], bounds[1:])
    speeds = point_speeds(motion(fine)[:, 0], motion(fine)[:, 1], ARM)
    assert np.all(speeds[:-1] <= np.repeat(between, 100, axis=0))
    rows = speed_bounds(motion(fine), 2e-4, ARM)
    np.testing.assert_allclose(rows, speeds, rtol=1e-3, atol=1e-3)  # finer samples, nearer bounds


def test_a_line_of_the_joints_is_nowhere_faster_than_its_bound_and_nearly_as_fast() -> None:
    rng = np.random.default_rng(3)
    for start, direction in zip(rng.uniform(-2, 2, (20, 6)), rng.uniform(-1, 1, (20, 6)), strict=True):
        bound = line_speed_bound(start, direction, 1.5, ARM)
        setpoints = start + np.linspace(0.0, 1.5, 20001)[:, None] * direction
        max_speed = difference_speeds(setpoints, 20000 / 1.5, ARM).max()
        assert max_speed <= bound <= 1.001 * max_speed
