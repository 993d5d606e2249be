from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import PathRefused
from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.paths.ik_branches import enumerate_candidates, is_usable
from teachpath.motion.paths.tool_path import sample_tool_path
from teachpath.motion.planning.certificate import plan_trajectory
from teachpath.motion.planning.plan import plan
from teachpath.motion.planning.torque_limited import time_within_torques
from teachpath.motion.settings import MotionSettings
from teachpath.records import Shape
from tests.unit.motion.ways import MIDDLE, way

ARM = Arm.of_variant()

LOAD = Shape("load", "box", (0.1, 0.1, 0.1), (0.0, 0.0, 0.0))
MASS = 0.3  # kg, of that size
RNG = np.random.default_rng(3)
Q = RNG.uniform(ARM.limits.lower, ARM.limits.upper, (50, 6))
V = RNG.uniform(-1, 1, (50, 6)) * ARM.limits.speed


def test_nothing_asks_more_than_the_bound() -> None:
    for carried in (None, LOAD):
        dynamics = Dynamics(ARM, carried)
        bound = dynamics.torque_bounds(Q, V, ARM.limits.acceleration)
        for _ in range(30):
            rate = RNG.uniform(-1, 1, (50, 1))
            acceleration = RNG.choice([-1.0, 1.0], (50, 6)) * ARM.limits.acceleration
            assert np.all(np.abs(dynamics.torques(Q, rate * V, acceleration)) <= bound + 1e-9)


def test_power_is_what_the_energy_gains() -> None:
    # Kinetic energy of a motion from rest, without gravity: of the load's mass alone, by the difference to no load.
    q, v, a, h = Q[:1], V[:1], 3.0 * V[:1], 1e-5

    def kinetic(at: np.ndarray, speed: np.ndarray) -> float:
        tip = [tool_pose(at + k * h * speed, ARM)[0, :3, 3] for k in (-1, 1)]
        return float(MASS / 2 * np.sum(((tip[1] - tip[0]) / (2 * h)) ** 2))

    loaded, bare = (Dynamics(ARM, carried).torques(q, v, a) for carried in (LOAD, None))
    power = float(np.sum((loaded - bare) * v))
    dt = 1e-4
    gain = (kinetic(q + dt * v, v + dt * a) - kinetic(q - dt * v, v - dt * a)) / (2 * dt)
    lift = MASS * 9.81 * float((tool_pose(q + dt * v, ARM) - tool_pose(q - dt * v, ARM))[0, 2, 3]) / (2 * dt)
    assert power == pytest.approx(gain + lift, rel=1e-4)


def test_the_share_of_acceleration_left_is_the_largest_that_the_motors_bear() -> None:
    dynamics = Dynamics(ARM, replace(LOAD, size=(0.25, 0.25, 0.25)))
    left = dynamics.acceleration_share(Q, V, ARM.limits.acceleration)
    assert 0.0 < left < 1.0
    assert np.max(dynamics.torque_bounds(Q, V, left * ARM.limits.acceleration) / ARM.limits.torque) == pytest.approx(
        1.0
    )
    assert Dynamics(ARM, replace(LOAD, size=(0.6, 0.6, 0.6))).acceleration_share(Q, V, ARM.limits.acceleration) < 0.0


def test_the_certified_torques_bound_those_of_the_plan() -> None:
    made = plan(way(MIDDLE), paper_scene())
    rows = plan_trajectory(made).table[::10]
    needed = Dynamics(ARM, paper_scene().carried).torques(*(rows[:, k, :6] for k in range(3)))
    assert 0.3 < (np.abs(needed) / ARM.limits.torque).max() < made.certificate.torque_use.value < 1.0


def test_what_is_too_heavy_is_refused_with_the_place_and_the_control_point() -> None:
    settings = MotionSettings()
    found = sample_tool_path(way(MIDDLE).curve, settings)
    candidate = next(c for c in enumerate_candidates(found, ARM, settings) if is_usable(c, settings))
    block = Shape("block", "box", (0.5, 0.5, 0.5), (0.0, 0.0, 0.0))
    with pytest.raises(PathRefused, match=r"torque at joint \d at s = .*carry less.*control point \d of 9"):
        time_within_torques(found, candidate, Dynamics(ARM, block), settings)
