from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import PathRefused
from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.kinematics import link_frames, tool_pose
from teachpath.motion.arm.model import Arm, Payload
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.paths.enumeration import enumerate_candidates
from teachpath.motion.paths.ik_branches import is_usable
from teachpath.motion.paths.tool_path import sample_tool_path
from teachpath.motion.planning.certificate import plan_trajectory
from teachpath.motion.planning.digest import verify
from teachpath.motion.planning.plan import plan
from teachpath.motion.planning.torque_limited import move_within_torques, time_within_torques
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


@pytest.mark.parametrize("center", [(0.0, 0.0, 0.13), (0.1, -0.05, 0.2)])
def test_a_payload_weighs_where_its_centre_is(center: tuple[float, float, float]) -> None:
    mass, still, h = 2.0, np.zeros_like(Q), 1e-6
    held, bare = (Dynamics(arm).torques(Q, still, still) for arm in (replace(ARM, payload=Payload(mass, center)), ARM))

    def height(q: np.ndarray) -> np.ndarray:
        return np.asarray((link_frames(q, ARM)[:, 6] @ np.array([*center, 1.0]))[:, 2])

    slopes = [(height(Q + h * turn) - height(Q - h * turn)) / (2 * h) for turn in np.eye(6)]
    np.testing.assert_allclose(held - bare, mass * 9.81 * np.transpose(slopes), atol=1e-6)


def test_a_payload_is_in_the_certificate_and_one_that_is_too_heavy_is_refused_with_the_setting() -> None:
    light, heavy = (replace(MotionSettings(), payload_mass=mass, payload_center=(0.0, 0.0, 0.2)) for mass in (0.0, 4.0))
    free, loaded = (plan(way(MIDDLE), paper_scene(), settings) for settings in (light, heavy))
    assert free.certificate.torque_use.value < loaded.certificate.torque_use.value <= 1.0
    assert loaded.duration >= free.duration
    verify(loaded, Arm.of_settings(heavy))
    for other in (light, replace(heavy, payload_mass=3.9), replace(heavy, payload_center=(0.0, 0.01, 0.2))):
        with pytest.raises(PathRefused, match="payload"):
            verify(loaded, Arm.of_settings(other))
    with pytest.raises(PathRefused, match=r"carry less \(motion\.payload_mass is 10 kg\)"):
        plan(way(MIDDLE), paper_scene(), replace(heavy, payload_mass=10.0, payload_center=(0.3, 0.3, 0.5)))


def test_a_move_keeps_the_motors_torques_whatever_the_arm_carries() -> None:
    start, goal = np.array(MotionSettings().home), np.array([-0.6, 0.9, -2.6, 0.3, -1.0, 0.2])
    durations = []
    for mass in (0.0, 6.0):
        arm = replace(ARM, payload=Payload(mass, (0.0, 0.0, 0.2)))
        moved = move_within_torques(start, goal, arm.limits.motion, Dynamics(arm), arm, "on the way")
        needed = Dynamics(arm).torques(*(moved.table[::10, k, :6] for k in range(3)))
        assert np.all(np.abs(needed) <= arm.limits.torque)
        durations.append(moved.duration)
    assert durations[0] < durations[1]
    arm = replace(ARM, payload=Payload(10.0, (0.4, 0.0, 0.5)))
    with pytest.raises(PathRefused, match=r"on the way: the motors are too weak .*motion\.payload_mass is 10 kg"):
        move_within_torques(start, goal, arm.limits.motion, Dynamics(arm), arm, "on the way")


def test_the_share_of_acceleration_left_is_the_largest_that_the_motors_bear() -> None:
    dynamics = Dynamics(ARM, replace(LOAD, size=(0.25, 0.25, 0.25)), np.eye(4))
    left = dynamics.acceleration_share(Q, V, ARM.limits.acceleration)
    assert 0.0 < left < 1.0
    assert np.max(dynamics.torque_bounds(Q, V, left * ARM.limits.acceleration) / ARM.limits.torque) == pytest.approx(
        1.0
    )
    heavy = Dynamics(ARM, replace(LOAD, size=(0.6, 0.6, 0.6)), np.eye(4))
    assert heavy.acceleration_share(Q, V, ARM.limits.acceleration) < 0.0


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
